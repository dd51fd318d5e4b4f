// Finished buffers by the key of what made them.
#pragma once

#include "runtime/core/buffer.h"

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace frustum {

// One node's published results: the buffers of its outputs, or a prepared pixel node.
struct CacheEntry {
  std::vector<Buffer> buffers;
  std::shared_ptr<const void> prepared = {};  // a PreparedNode
  std::uint64_t prepared_bytes = 0;           // what it holds besides buffers
};

// In memory, least recently used first out. Thread-safe.
class MemoryCache {
 public:
  explicit MemoryCache(std::uint64_t limit_bytes = std::uint64_t{2} << 30) : limit_(limit_bytes) {}

  std::optional<CacheEntry> find(const Digest& key);
  void insert(const Digest& key, CacheEntry entry);
  std::uint64_t bytes() const;
  void clear();

 private:
  struct Item {
    Digest key;
    CacheEntry entry;
    std::uint64_t bytes;
  };
  mutable std::mutex mutex_;
  std::list<Item> items_;  // most recent first
  std::map<Digest, std::list<Item>::iterator> index_;
  std::uint64_t limit_, bytes_ = 0;
};

}  // namespace frustum
