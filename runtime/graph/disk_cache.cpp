#include "runtime/graph/disk_cache.h"

#include "runtime/core/error.h"
#include "runtime/core/temporary_files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>
#include <new>

namespace frustum {
namespace {

namespace fs = std::filesystem;

constexpr std::align_val_t cache_line{64};

std::shared_ptr<void> aligned_storage(std::size_t bytes) {
  void* p = ::operator new(std::max<std::size_t>(bytes, 1), cache_line);
  return {p, [](void* data) { ::operator delete(data, cache_line); }};
}

}  // namespace

// ----- a buffer's bytes with its columns beside it

class DiskWriter : public ArchiveWriter {
 public:
  DiskWriter(DiskCache& cache, CacheFileWriter& file) : cache_(cache), file_(file) {}
  void raw(const void* data, std::size_t bytes) override { file_.write(data, bytes); }
  void shared(const std::shared_ptr<const void>& storage, std::size_t bytes) override {
    const auto digest = complete_ ? cache_.store_column(storage, bytes) : std::nullopt;
    complete_ = digest.has_value();
    if (complete_) value(digest->high).value(digest->low);
  }
  bool complete() const { return complete_; }

 private:
  DiskCache& cache_;
  CacheFileWriter& file_;
  bool complete_ = true;
};

class DiskReader : public ArchiveReader {
 public:
  DiskReader(DiskCache& cache, std::span<const std::byte> bytes) : cache_(cache), bytes_(bytes) {}
  void raw(void* to, std::size_t bytes) override {
    if (bytes > bytes_.size()) throw ArchiveError("the content ends early");
    if (bytes != 0) std::memcpy(to, bytes_.data(), bytes);
    bytes_ = bytes_.subspan(bytes);
  }
  std::size_t left() const override { return bytes_.size(); }
  std::shared_ptr<void> shared(std::size_t bytes) override {
    const auto high = value<std::uint64_t>(), low = value<std::uint64_t>();
    return cache_.load_column({high, low}, bytes);
  }

 private:
  DiskCache& cache_;
  std::span<const std::byte> bytes_;
};

namespace {
// A column that the buffer names has been evicted: a miss, and nothing is damaged.
struct ColumnGone {};
}  // namespace

std::string_view name_of(DiskCache::Store s) {
  switch (s) {
    case DiskCache::Store::stored: return "stored";
    case DiskCache::Store::there_already: return "there_already";
    case DiskCache::Store::not_storable: return "not_storable";
    case DiskCache::Store::too_large: return "too_large";
    case DiskCache::Store::disabled: return "disabled";
  }
  return "";
}

DiskCache::DiskCache(fs::path folder, std::uint64_t limit_bytes)
    : folder_(std::move(folder)), limit_(limit_bytes) {
  std::error_code error, unmade;
  fs::create_directories(folder_, unmade);
  if (!fs::is_directory(folder_, error) || ::access(folder_.c_str(), R_OK | X_OK) != 0)
    throw WorldError("cache_unusable",
                     fmt::format("{} cannot be used as a folder for the cache: {}", folder_.string(),
                                 error && unmade ? unmade.message()
                                 : error         ? error.message()
                                                 : "it is no folder, or may not be read"));
  fs::create_directories(folder_ / "tmp", error);
  if (!error) fs::create_directories(folder_ / "objects", error);
  if (!error) fs::create_directories(folder_ / "graphs", error);
  if (error) disable(fault_of_errno(error.value()));
  // Backup programs leave folders with this file alone (bford.info/cachedir).
  if (const fs::path tag = folder_ / "CACHEDIR.TAG"; storing_ && !fs::exists(tag, error))
    std::ofstream(tag) << "Signature: 8a477f597d28d172789f06886806bc55\n# Buffers kept by frustum; may be "
                          "deleted at any time.\n";
}

// ----- names

fs::path DiskCache::path_of(const Digest& key, std::string_view ending) const {
  const std::string hex = to_hex(key);
  return folder_ / "objects" / hex.substr(0, 2) / fmt::format("{}.{}", hex, ending);
}

fs::path DiskCache::temporary() const {
  const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
  return folder_ / "tmp" / fmt::format("{}.{}.{:x}", ::getpid(), temporaries_++, now);
}

bool DiskCache::contains(const Digest& key) const {
  return ::access(path_of(key, "buffer").c_str(), F_OK) == 0;
}

void DiskCache::remove(const Digest& key) { ::unlink(path_of(key, "buffer").c_str()); }

// ----- what went wrong

void DiskCache::warn(std::string code, std::string message) {
  const std::lock_guard lock(mutex_);
  warnings_.emplace_back(std::move(code), std::move(message));
}

std::vector<std::pair<std::string, std::string>> DiskCache::take_warnings() {
  const std::lock_guard lock(mutex_);
  return std::exchange(warnings_, {});
}

void DiskCache::damaged(const fs::path& name) {
  const bool first = damaged_++ == 0;
  const bool gone = ::unlink(name.c_str()) == 0;
  if (first)
    warn("cache_damaged",
         fmt::format("{} is damaged or not a file of this cache; {}, and what it held is computed anew",
                     name.string(), gone ? "it is removed" : "it cannot be removed"));
}

void DiskCache::disable(FileFault why) {
  if (!storing_.exchange(false)) return;
  const std::string_view code = why == FileFault::no_room  ? "cache_disk_full"
                                : why == FileFault::denied ? "cache_read_only"
                                                           : "cache_failed";
  warn(std::string(code),
       fmt::format("the cache {} {}: nothing more is stored in this run", folder_.string(), name_of(why)));
}

// ----- reading

Buffer DiskCache::load(const Digest& key, std::span<const BufferType* const> kinds) {
  const fs::path name = path_of(key, "buffer");
  std::unique_ptr<std::byte[]> bytes;
  std::size_t size = 0;
  try {
    const FileFault fault = read_cache_file(name, CacheContent::buffer, key, [&](std::size_t n) {
      bytes.reset(new std::byte[n]);
      return size = n, bytes.get();
    });
    if (fault == FileFault::corrupt) damaged(name);
    if (fault != FileFault::none) return {};
    DiskReader reader(*this, {bytes.get(), size});
    const std::string kind = reader.text();
    const auto high = reader.value<std::uint64_t>(), low = reader.value<std::uint64_t>();
    for (const BufferType* type : kinds)
      if (type->name == kind && type->load != nullptr) {
        Buffer b = type->load(reader);
        if (reader.left() != 0 || b.digest() != Digest{high, low})
          throw ArchiveError("another value than was stored");
        return b;
      }
    damaged(name);
  } catch (const ArchiveError&) {
    damaged(name);
  } catch (const ColumnGone&) {
    ::unlink(name.c_str());
  } catch (const std::bad_alloc&) {
  } catch (const WorldError&) {  // no memory for it; the run may need less
  }
  return {};
}

std::shared_ptr<void> DiskCache::load_column(const Digest& digest, std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = loaded_.find(digest); found != loaded_.end())
      if (auto alive = found->second.lock()) return alive;
  }
  const fs::path name = path_of(digest, "column");
  std::shared_ptr<void> storage;
  std::size_t size = 0;
  const FileFault fault = read_cache_file(name, CacheContent::column, digest, [&](std::size_t n) {
    storage = aligned_storage(n);
    return size = n, storage.get();
  });
  if (fault == FileFault::corrupt) damaged(name);
  if (fault != FileFault::none) throw ColumnGone();
  if (size != bytes) throw ArchiveError("a column of another size");
  const std::lock_guard lock(mutex_);
  loaded_[digest] = storage;
  stored_[storage.get()] = {storage, bytes, digest};
  return storage;
}

std::optional<std::string> DiskCache::load_notes(const Digest& key) {
  std::string text;
  const fs::path name = path_of(key, "notes");
  const FileFault fault = read_cache_file(name, CacheContent::notes, key, [&](std::size_t n) {
    text.resize(n);
    return text.data();
  });
  if (fault == FileFault::corrupt) damaged(name);
  return fault == FileFault::none ? std::optional(text) : std::nullopt;
}

// ----- writing

bool DiskCache::finish(CacheFileWriter& file, const Digest& key, const fs::path& name) {
  std::error_code error;
  fs::create_directory(name.parent_path(), error);
  FileFault fault = file.fault();
  if (fault == FileFault::none) fault = error ? fault_of_errno(error.value()) : file.commit(key, name);
  if (fault != FileFault::none) return disable(fault), false;
  added(file.bytes());
  return true;
}

DiskCache::Store DiskCache::store(const Digest& key, const Buffer& buffer) {
  if (buffer.type().save == nullptr) return Store::not_storable;
  if (buffer.bytes() > limit_ / 2) return Store::too_large;
  if (!storing_) return Store::disabled;
  if (contains(key)) return Store::there_already;
  try {
    CacheFileWriter file(temporary(), CacheContent::buffer);
    DiskWriter writer(*this, file);
    const Digest digest = buffer.digest();
    writer.text(buffer.type().name).value(digest.high).value(digest.low);
    buffer.type().save(buffer.data(), writer);
    if (writer.complete() && finish(file, key, path_of(key, "buffer"))) return Store::stored;
  } catch (const std::bad_alloc&) {  // 64 KiB that are not there: the run has other worries
  }
  return Store::disabled;
}

std::optional<Digest> DiskCache::store_column(const std::shared_ptr<const void>& storage, std::size_t bytes) {
  std::optional<Digest> known;
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = stored_.find(storage.get()); found != stored_.end())
      if (found->second.storage.lock() == storage && found->second.bytes == bytes)
        known = found->second.digest;
  }
  const Digest digest = known ? *known : Hasher().bytes(storage.get(), bytes).done();
  const fs::path name = path_of(digest, "column");
  if (::utimensat(AT_FDCWD, name.c_str(), nullptr, 0) != 0) {
    CacheFileWriter file(temporary(), CacheContent::column);
    file.write(storage.get(), bytes);
    if (!finish(file, digest, name)) return std::nullopt;
  }
  const std::lock_guard lock(mutex_);
  stored_[storage.get()] = {storage, bytes, digest};
  return digest;
}

void DiskCache::store_notes(const Digest& key, std::string_view text) {
  if (!storing_) return;
  CacheFileWriter file(temporary(), CacheContent::notes);
  file.write(text.data(), text.size());
  finish(file, key, path_of(key, "notes"));
}

// ----- the last keys of a graph

namespace {
fs::path index_path(const fs::path& folder, std::string_view graph) {
  return folder / "graphs" / (to_hex(Hasher().text(graph).done()) + ".json");
}
}  // namespace

std::optional<std::string> DiskCache::load_index(std::string_view graph) {
  constexpr std::uintmax_t most_bytes = 64 << 20;  // no graph has that many nodes
  const fs::path name = index_path(folder_, graph);
  std::error_code error;
  if (const auto size = fs::file_size(name, error); error || size > most_bytes) return std::nullopt;
  std::ifstream in(name, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

void DiskCache::store_index(std::string_view graph, std::string_view text) {
  if (!storing_) return;
  const fs::path part = temporary();
  remember_temporary_file(part);
  std::ofstream out(part, std::ios::binary);
  out << text;
  out.close();
  std::error_code error;
  if (out) fs::rename(part, index_path(folder_, graph), error);
  if (!out || error) fs::remove(part, error);
  forget_temporary_file(part);
}

}  // namespace frustum
