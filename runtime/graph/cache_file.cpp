#include "runtime/graph/cache_file.h"

#include "runtime/core/temporary_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace frustum {
namespace {

// The last byte is the version of this layout; a processor of the other byte order reads another word.
constexpr std::uint64_t magic = 0x01'4d'55'54'53'55'52'46;  // "FRUSTUM\1"
constexpr std::size_t block_bytes = std::size_t{1} << 16;

struct Header {
  std::uint64_t magic = 0;
  CacheContent content{};
  std::uint32_t unused = 0;
  Digest key;               // under which the file is found
  std::uint64_t bytes = 0;  // of the content
  Digest digest;            // of the content
  std::uint64_t check = 0;  // of everything above
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);

std::uint64_t check_of(const Header& h) { return Hasher().bytes(&h, offsetof(Header, check)).done().low; }

class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// All of it, or false.
bool read_all(int fd, void* to, std::size_t bytes) {
  auto* at = static_cast<std::byte*>(to);
  while (bytes > 0) {
    const ssize_t n = ::read(fd, at, std::min(bytes, std::size_t{1} << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    at += n;
    bytes -= static_cast<std::size_t>(n);
  }
  return true;
}

}  // namespace

FileFault fault_of_errno(int error) {
  switch (error) {
    case 0: return FileFault::none;
    case ENOENT:
    case ENOTDIR: return FileFault::missing;
    case ENOSPC:
    case EDQUOT:
    case EFBIG: return FileFault::no_room;
    case EACCES:
    case EPERM:
    case EROFS: return FileFault::denied;
    default: return FileFault::io;
  }
}

std::string_view name_of(FileFault f) {
  switch (f) {
    case FileFault::none: return "is well";
    case FileFault::missing: return "is not there";
    case FileFault::corrupt: return "is damaged";
    case FileFault::no_room: return "is full";
    case FileFault::denied: return "may not be written";
    case FileFault::io: return "cannot be written";
  }
  return "";
}

CacheFileWriter::CacheFileWriter(const std::filesystem::path& temporary, CacheContent content)
    : temporary_(temporary), content_(content), block_(std::make_unique<std::byte[]>(block_bytes)) {
  remember_temporary_file(temporary_);
  file_ = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (file_ < 0) {
    fault_ = fault_of_errno(errno);
    forget_temporary_file(temporary_);
    return;
  }
  const Header room{};
  put(reinterpret_cast<const std::byte*>(&room), sizeof room);
}

CacheFileWriter::~CacheFileWriter() {
  if (file_ < 0) return;
  ::close(file_);
  ::unlink(temporary_.c_str());
  forget_temporary_file(temporary_);
}

void CacheFileWriter::put(const std::byte* data, std::size_t bytes) {
  while (bytes > 0 && fault_ == FileFault::none) {
    const ssize_t n = ::write(file_, data, std::min(bytes, std::size_t{1} << 30));
    if (n < 0) {
      if (errno != EINTR) fault_ = fault_of_errno(errno);
      continue;
    }
    data += n;
    bytes -= static_cast<std::size_t>(n);
    written_ += static_cast<std::uint64_t>(n);
  }
}

void CacheFileWriter::flush() {
  put(block_.get(), filled_);
  filled_ = 0;
}

// Rows of pixels are small and columns are large: what fits is gathered, the rest goes straight to the file.
void CacheFileWriter::write(const void* data, std::size_t bytes) {
  if (fault_ != FileFault::none) return;
  hasher_.bytes(data, bytes);
  if (filled_ + bytes > block_bytes) flush();
  if (bytes > block_bytes) return put(static_cast<const std::byte*>(data), bytes);
  if (bytes != 0) std::memcpy(block_.get() + filled_, data, bytes);
  filled_ += bytes;
}

FileFault CacheFileWriter::commit(const Digest& key, const std::filesystem::path& name) {
  flush();
  if (fault_ != FileFault::none) return fault_;
  Header h{.magic = magic,
           .content = content_,
           .unused = 0,
           .key = key,
           .bytes = written_ - sizeof(Header),
           .digest = digest(),
           .check = 0};
  h.check = check_of(h);
  if (::pwrite(file_, &h, sizeof h, 0) != static_cast<ssize_t>(sizeof h))
    return fault_ = fault_of_errno(errno);
  // Some file systems say only now that there was no room.
  const int closed = ::close(file_);
  file_ = -1;
  if (closed != 0 || ::rename(temporary_.c_str(), name.c_str()) != 0) {
    fault_ = fault_of_errno(errno);
    ::unlink(temporary_.c_str());
  }
  forget_temporary_file(temporary_);
  return fault_;
}

FileFault read_cache_file(const std::filesystem::path& name, CacheContent content, const Digest& key,
                          const std::function<void*(std::size_t)>& allocate) {
  const Descriptor file(::open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK));
  if (file.get() < 0) return errno == ELOOP ? FileFault::corrupt : fault_of_errno(errno);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) return FileFault::io;
  Header h;
  if (!S_ISREG(status.st_mode) || !read_all(file.get(), &h, sizeof h)) return FileFault::corrupt;
  if (h.magic != magic || h.check != check_of(h) || h.content != content || h.key != key ||
      h.bytes + sizeof h != static_cast<std::uint64_t>(status.st_size))
    return FileFault::corrupt;
  void* to = allocate(h.bytes);
  if (!read_all(file.get(), to, h.bytes)) return FileFault::corrupt;
  if (Hasher().bytes(to, h.bytes).done() != h.digest) return FileFault::corrupt;
  ::futimens(file.get(), nullptr);
  return FileFault::none;
}

void touch(const std::filesystem::path& name) { ::utimensat(AT_FDCWD, name.c_str(), nullptr, 0); }

}  // namespace frustum
