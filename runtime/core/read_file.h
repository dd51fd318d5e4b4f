// Regular files, opened so that nothing else can make the program wait: a pipe without a writer would, and
// a device has no end.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace frustum {

// An open regular file. `written` is its name in messages.
// Throws WorldError("cannot_read_file"), "cannot read teapot.obj: No such file or directory".
class RegularFile {
 public:
  RegularFile(const std::string& path, std::string_view written);
  ~RegularFile();
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  int descriptor() const { return descriptor_; }
  std::size_t size() const { return size_; }  // when it was opened
  [[noreturn]] void fail(int error) const;    // throws WorldError("cannot_read_file")

 private:
  std::string written_;
  int descriptor_ = -1;
  std::size_t size_ = 0;
};

// All of a regular file, to its end as it is found while reading. Throws WorldError("cannot_read_file"),
// std::bad_alloc.
std::string read_file(const std::string& path);

}  // namespace frustum
