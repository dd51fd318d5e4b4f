// Finished buffers on disk, by the key of what made them: shared by runs and processes, and never trusted.
//
//   DIR/objects/ab/<key>.buffer   a buffer; of a mesh, only what is not in its columns
//   DIR/objects/ab/<key>.column   the numbers of a column, by their own digest: stored once, whatever shares them
//   DIR/objects/ab/<key>.notes    what a node said when it ran: warnings, the first NaN
//   DIR/graphs/<path's digest>.json   the keys that each graph's nodes had last, to say why a node was not found
//   DIR/tmp/                      files being written; a rename makes them visible whole
//
// A file that is cut short, altered, or not ours is a miss: it is said (`damaged`) and removed. A full disk or a folder that
// may not be written ends storing for this run with one warning, and the run goes on. Several processes may use a folder at
// once: names appear by rename, the same name always has the same bytes, and one process at a time evicts.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/graph/cache_file.h"

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace frustum {

class DiskCache {
 public:
  static constexpr std::uint64_t default_limit_bytes = std::uint64_t{10} << 30;

  // Makes the folder where it is not there; throws WorldError("cache_unusable") where it cannot be used at all.
  explicit DiskCache(std::filesystem::path folder, std::uint64_t limit_bytes = default_limit_bytes);
  ~DiskCache();  // evicts where more was stored than the limit allows

  const std::filesystem::path& folder() const { return folder_; }

  // The buffer under the key, if it is of one of the kinds; empty otherwise. Its digest is compared
  // with that of the buffer that was stored. Cost: one read and two hashes of its bytes.
  Buffer load(const Digest& key, std::span<const BufferType* const> kinds);
  bool contains(const Digest& key) const;  // by name only

  enum class Store : std::uint8_t { stored, there_already, not_storable, too_large, disabled };
  // Stores columns first, so that a buffer that is visible has all its parts. Never throws for what the disk does.
  Store store(const Digest& key, const Buffer& buffer);
  void remove(const Digest& key);

  // Small texts beside the buffers: JSON of what a node said.
  std::optional<std::string> load_notes(const Digest& key);
  void store_notes(const Digest& key, std::string_view text);

  // A file of the folder `graphs`: of the last run of a graph.
  std::optional<std::string> load_index(std::string_view graph);
  void store_index(std::string_view graph, std::string_view text);

  // Removes the files that were used longest ago until nine tenths of the limit are left, and temporary files that a
  // process left behind an hour ago. Does nothing while another process does the same.
  void evict();

  // (code, sentence) of what went wrong since the last call; each cause is said once.
  std::vector<std::pair<std::string, std::string>> take_warnings();
  std::uint64_t damaged() const { return damaged_; }  // files found damaged and removed

 private:
  friend class DiskReader;
  friend class DiskWriter;
  std::filesystem::path path_of(const Digest& key, std::string_view ending) const;
  std::filesystem::path temporary() const;
  bool finish(CacheFileWriter& file, const Digest& key, const std::filesystem::path& name);
  void damaged(const std::filesystem::path& name);
  void disable(FileFault why);
  void warn(std::string code, std::string message);
  void added(std::uint64_t bytes);

  std::shared_ptr<void> load_column(const Digest& digest, std::size_t bytes);
  // The digest of a column that is on disk now; null where it could not be stored.
  std::optional<Digest> store_column(const std::shared_ptr<const void>& storage, std::size_t bytes);

  std::filesystem::path folder_;
  std::uint64_t limit_;
  std::atomic<bool> storing_{true};
  std::atomic<std::uint64_t> damaged_{0};
  mutable std::atomic<std::uint64_t> temporaries_{0};

  std::mutex mutex_;
  std::vector<std::pair<std::string, std::string>> warnings_;
  std::optional<std::uint64_t> size_;  // of all objects, as far as this process knows; not counted yet: null
  std::map<Digest, std::weak_ptr<void>> loaded_;  // columns, so that buffers loaded apart share them again
  struct StoredColumn {
    std::weak_ptr<const void> storage;  // tells the storage from another that came to lie at its address
    std::size_t bytes;
    Digest digest;
  };
  std::unordered_map<const void*, StoredColumn> stored_;
};

std::string_view name_of(DiskCache::Store);

}  // namespace frustum
