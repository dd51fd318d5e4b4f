#include "runtime/core/read_file.h"

#include "runtime/core/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace frustum {
namespace {

[[noreturn]] void cannot_read(std::string_view written, std::string_view why) {
  throw WorldError("cannot_read_file", fmt::format("cannot read {}: {}", written, why));
}

}  // namespace

RegularFile::RegularFile(const std::string& path, std::string_view written) : written_(written) {
  // Without O_NONBLOCK the opening of a pipe lasts until somebody writes to it.
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor_ < 0) fail(errno);
  struct stat info {};
  const int error = ::fstat(descriptor_, &info) != 0 ? errno : S_ISDIR(info.st_mode) ? EISDIR : 0;
  if (error == 0 && S_ISREG(info.st_mode)) {
    size_ = static_cast<std::size_t>(info.st_size);
    return;
  }
  ::close(descriptor_);
  cannot_read(written_, error != 0 ? std::strerror(error) : "it is not a regular file");
}

RegularFile::~RegularFile() { ::close(descriptor_); }

void RegularFile::fail(int error) const { cannot_read(written_, std::strerror(error)); }

std::string read_file(const std::string& path) {
  const RegularFile file(path, path);
  // A byte more than the file is said to have finds its end at once; one that has grown, or has no size (in
  // /proc), takes more rounds.
  std::string text(file.size() + 1, '\0');
  std::size_t have = 0;
  for (;;) {
    if (have == text.size()) text.resize(std::max<std::size_t>(4096, have + have / 2));
    const ssize_t n = ::read(file.descriptor(), text.data() + have, text.size() - have);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) file.fail(errno);
    if (n == 0) break;
    have += static_cast<std::size_t>(n);
  }
  text.resize(have);
  return text;
}

}  // namespace frustum
