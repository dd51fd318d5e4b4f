// A whole file in memory, and how a place in it is said to the user.
#pragma once

#include "runtime/core/param.h"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace frustum {

// Reads a regular file whole. It is copied and not mapped: a mapped file that shrinks meanwhile would end
// the process with SIGBUS, and a copy in parallel blocks costs some 15 ms per 100 MB.
// Throws NodeError("no_file") where the path is empty, WorldError("cannot_read_file") where the file cannot
// be read.
class FileBytes {
 public:
  explicit FileBytes(const FilePath& path);
  std::string_view text() const { return {data_.get(), size_}; }

 private:
  std::unique_ptr<char[]> data_;
  std::size_t size_ = 0;
};

// "teapot.obj:17" for byte `offset` of `text`; lines count from 1.
std::string place_in(const FilePath& path, std::string_view text, std::size_t offset);

}  // namespace frustum
