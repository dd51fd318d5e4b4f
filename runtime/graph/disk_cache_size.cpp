// How large the folder of a DiskCache is, and what goes when that is too much.
#include "runtime/graph/disk_cache.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>

namespace frustum {
namespace {

namespace fs = std::filesystem;

struct ObjectFile {
  fs::path path;
  std::uint64_t bytes = 0;
  timespec used{};
};

bool earlier(const ObjectFile& a, const ObjectFile& b) {
  if (a.used.tv_sec != b.used.tv_sec) return a.used.tv_sec < b.used.tv_sec;
  return a.used.tv_nsec != b.used.tv_nsec ? a.used.tv_nsec < b.used.tv_nsec : a.path < b.path;
}

// Every regular file below `folder`; what vanishes meanwhile or cannot be read is left out.
std::vector<ObjectFile> files_below(const fs::path& folder) {
  std::vector<ObjectFile> files;
  std::error_code ignored;
  for (fs::recursive_directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    struct stat s {};
    if (::lstat(at->path().c_str(), &s) == 0 && S_ISREG(s.st_mode))
      files.push_back({at->path(), static_cast<std::uint64_t>(s.st_size), s.st_mtim});
    if (ignored) break;
  }
  return files;
}

}  // namespace

DiskCache::~DiskCache() {
  if (size_ && *size_ > limit_) evict();
}

void DiskCache::added(std::uint64_t bytes) {
  bool over = false;
  {
    const std::lock_guard lock(mutex_);
    if (!size_) {
      size_ = 0;
      for (const ObjectFile& f : files_below(folder_ / "objects")) *size_ += f.bytes;
    } else {
      *size_ += bytes;
    }
    over = *size_ > limit_;
  }
  if (over) evict();
}

void DiskCache::evict() {
  const int lock = ::open((folder_ / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock < 0) return;
  if (::flock(lock, LOCK_EX | LOCK_NB) == 0) {
    std::vector<ObjectFile> files = files_below(folder_ / "objects");
    std::sort(files.begin(), files.end(), earlier);
    std::uint64_t total = 0;
    for (const ObjectFile& f : files) total += f.bytes;
    const std::uint64_t goal = total > limit_ ? limit_ - limit_ / 10 : limit_;
    for (const ObjectFile& f : files) {
      if (total <= goal) break;
      if (::unlink(f.path.c_str()) == 0) total -= f.bytes;
    }
    const std::time_t hour_ago = std::time(nullptr) - 3600;
    for (const ObjectFile& f : files_below(folder_ / "tmp"))
      if (f.used.tv_sec < hour_ago) ::unlink(f.path.c_str());
    const std::lock_guard guard(mutex_);
    size_ = total;
  }
  ::close(lock);
}

}  // namespace frustum
