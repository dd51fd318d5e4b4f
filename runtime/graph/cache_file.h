// One file of the cache on disk: 64 bytes of header, then the content that it vouches for.
#pragma once

#include "runtime/core/archive.h"
#include "runtime/core/digest.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace frustum {

// What a file holds; part of the header, so that one under another's name is found out.
enum class CacheContent : std::uint32_t { buffer = 1, column = 2, notes = 3 };

// Why a file was not read or written.
enum class FileFault : std::uint8_t {
  none,
  missing,  // no such file
  corrupt,  // not a file of ours, cut short, or with other bytes than were written
  no_room,  // the disk, or the quota, is full
  denied,   // no permission, or a read-only file system
  io,       // anything else that the system says
};

// Writes under a temporary name, hashing on the way; commit() puts the header in front and renames. A file that is not
// committed is removed. No fsync: after a power cut the digest tells a whole file from a torn one, and a cache may forget.
class CacheFileWriter {
 public:
  CacheFileWriter(const std::filesystem::path& temporary, CacheContent content);
  ~CacheFileWriter();
  CacheFileWriter(const CacheFileWriter&) = delete;
  CacheFileWriter& operator=(const CacheFileWriter&) = delete;

  void write(const void* data, std::size_t bytes);  // does nothing after a fault
  FileFault commit(const Digest& key, const std::filesystem::path& name);
  FileFault fault() const { return fault_; }
  Digest digest() const { return hasher_.done(); }  // of what was written so far
  std::uint64_t bytes() const { return written_; }  // of the file, header included

 private:
  void flush();
  void put(const std::byte* data, std::size_t bytes);

  std::filesystem::path temporary_;
  CacheContent content_;
  int file_ = -1;
  FileFault fault_ = FileFault::none;
  Hasher hasher_;
  std::unique_ptr<std::byte[]> block_;
  std::size_t filled_ = 0;
  std::uint64_t written_ = 0;
};

// Reads a file whole, content and digest checked. `allocate` gives the memory for the content, whose size is that of the
// file and so cannot lie. A file that was read is marked as used now, for eviction.
FileFault read_cache_file(const std::filesystem::path& name, CacheContent content, const Digest& key,
                          const std::function<void*(std::size_t bytes)>& allocate);

FileFault fault_of_errno(int error);
std::string_view name_of(FileFault);  // "is full", "may not be written", ...

// Marks a file as used now: eviction goes by the time of modification, since access times are often not kept.
void touch(const std::filesystem::path& name);

}  // namespace frustum
