#include "runtime/core/partial_file.h"

#include "runtime/core/error.h"
#include "runtime/core/temporary_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace frustum {
namespace {

std::atomic<unsigned> serial{0};

std::string temporary_name(const std::filesystem::path& path) {
  return (path.parent_path() / fmt::format(".{}.{}-{}.part", path.filename().string(), getpid(), serial++))
      .string();
}

// Another run that fails may remove the folder while it is still empty; it is made again then. Where it cannot be made,
// errno says why.
int open_with_folder(const std::filesystem::path& path, const std::string& temporary) {
  int fd = -1;
  for (int attempt = 0; attempt < 5; ++attempt) {
    std::error_code error;
    if (const auto folder = path.parent_path(); !folder.empty())
      std::filesystem::create_directories(folder, error);
    fd = open(temporary.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != ENOENT) break;
    if (error) errno = error.value();
  }
  return fd;
}

}  // namespace

PartialFile::PartialFile(const std::string& path) : path_(path), temporary_(temporary_name(path)) {
  std::error_code error;
  // The new file would take the place of a device or a pipe.
  if (const auto there = std::filesystem::status(path, error);
      std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))
    throw WorldError("cannot_write_file", fmt::format("cannot write {}: it is not a regular file", path));
  folders_.above(path);
  remember_temporary_file(temporary_);
  const int fd = open_with_folder(path, temporary_);
  if (fd >= 0) file_ = fdopen(fd, "w+b");
  if (file_ == nullptr) {
    const int why = errno;
    if (fd >= 0) ::close(fd), unlink(temporary_.c_str());
    forget_temporary_file(temporary_);
    fail(why);
  }
  std::setvbuf(file_, nullptr, _IOFBF, std::size_t{1} << 20);
}

PartialFile::~PartialFile() {
  if (file_ != nullptr) std::fclose(file_);
  if (temporary_.empty()) return;
  unlink(temporary_.c_str());
  forget_temporary_file(temporary_);
}

void PartialFile::fail(int error) const {
  throw WorldError("cannot_write_file", fmt::format("cannot write {}: {}", path_, std::strerror(error)));
}

void PartialFile::check() const {
  if (error_ != 0) fail(error_);
}

void PartialFile::commit() {
  check();
  if (std::fflush(file_) != 0) fail(errno);
  const int closed = std::fclose(std::exchange(file_, nullptr));
  if (closed != 0) fail(errno);
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail(errno);
  forget_temporary_file(temporary_);
  temporary_.clear();
  folders_.keep();
}

void PartialFile::remember() {
  if (error_ == 0) error_ = errno != 0 ? errno : EIO;
}

bool PartialFile::seek(std::int64_t offset) {
  if (fseeko(file_, static_cast<off_t>(offset), SEEK_SET) != 0) {
    remember();
    return false;
  }
  at_ = offset;
  return true;
}

std::size_t PartialFile::write(const void* from, std::size_t size) {
  const std::size_t n = std::fwrite(from, 1, size, file_);
  if (n != size) remember();
  at_ += static_cast<std::int64_t>(n);
  size_ = std::max(size_, at_);
  return n;
}

std::size_t PartialFile::read(void* to, std::size_t size) {
  std::fflush(file_);  // between writing and reading, as the C standard asks
  const std::size_t n = std::fread(to, 1, size, file_);
  at_ += static_cast<std::int64_t>(n);
  std::fseek(file_, 0, SEEK_CUR);
  return n;
}

}  // namespace frustum
