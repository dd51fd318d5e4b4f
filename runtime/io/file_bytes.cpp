#include "runtime/io/file_bytes.h"

#include "runtime/core/error.h"
#include "runtime/core/read_file.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <new>

namespace frustum {
namespace {

// Returns 0, or the error number; a file that has become shorter is EIO.
int read_block(int fd, char* to, std::size_t size, std::size_t offset) {
  while (size != 0) {
    const ssize_t n = pread(fd, to, size, static_cast<off_t>(offset));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return n < 0 ? errno : EIO;
    to += n, offset += static_cast<std::size_t>(n), size -= static_cast<std::size_t>(n);
  }
  return 0;
}

}  // namespace

FileBytes::FileBytes(const FilePath& path) {
  if (path.empty()) throw NodeError("no_file", "no file is named");
  const RegularFile file(path.resolved, path.written);
  size_ = file.size();
  try {
    data_ = std::make_unique_for_overwrite<char[]>(size_);
  } catch (const std::bad_alloc&) {
    throw WorldError("out_of_memory", fmt::format("no memory for the {} bytes of {}", size_, path.written));
  }
  constexpr std::size_t block = std::size_t{4} << 20;
  std::atomic<int> error{0};
  tbb::parallel_for(std::size_t{0}, (size_ + block - 1) / block, [&](std::size_t i) {
    const std::size_t at = i * block;
    if (const int e = read_block(file.descriptor(), data_.get() + at, std::min(block, size_ - at), at);
        e != 0)
      error = e;
  });
  if (error != 0) file.fail(error);
}

std::string place_in(const FilePath& path, std::string_view text, std::size_t offset) {
  const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size()));
  return fmt::format("{}:{}", path.written, 1 + std::count(text.begin(), end, '\n'));
}

}  // namespace frustum
