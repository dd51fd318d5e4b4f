// A file under a temporary name that becomes visible when it is whole.
#pragma once

#include "runtime/core/new_folders.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace frustum {

// A stream to read, write and seek in, which remembers the first error of the operating system (a full
// disk): image libraries drop some of them.
class PartialFile {
 public:
  // Makes ".NAME.<process>-<number>.part" in the folder of `path`, and that folder where it is missing.
  // Throws WorldError("cannot_write_file").
  explicit PartialFile(const std::string& path);
  ~PartialFile();  // removes the file, unless commit() has renamed it, and empty folders made for it
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  void check() const;  // throws WorldError("cannot_write_file") where something has failed
  void commit();       // flushes, closes, renames

  std::int64_t tell() const { return at_; }
  std::int64_t size() const { return size_; }
  bool seek(std::int64_t offset);
  // Bytes done; fewer than asked for at the end of the file, or where it failed.
  std::size_t read(void* to, std::size_t size);
  std::size_t write(const void* from, std::size_t size);
  void add(std::string_view text) {
    write(text.data(), text.size());
  }  // check() and commit() say what failed

 private:
  [[noreturn]] void fail(int error) const;
  void remember();

  NewFolders folders_;  // first, since it goes last
  std::string path_, temporary_;
  std::FILE* file_ = nullptr;
  std::int64_t at_ = 0, size_ = 0;
  int error_ = 0;
};

}  // namespace frustum
