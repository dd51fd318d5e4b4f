#include "runtime/graph/cache.h"

namespace frustum {

std::optional<CacheEntry> MemoryCache::find(const Digest& key) {
  const std::lock_guard lock(mutex_);
  const auto found = index_.find(key);
  if (found == index_.end()) return std::nullopt;
  items_.splice(items_.begin(), items_, found->second);
  return found->second->entry;
}

void MemoryCache::insert(const Digest& key, CacheEntry entry) {
  std::uint64_t bytes = entry.prepared_bytes;
  for (const Buffer& b : entry.buffers) bytes += b.bytes();
  if (bytes > limit_) return;
  const std::lock_guard lock(mutex_);
  if (const auto found = index_.find(key); found != index_.end()) {
    bytes_ -= found->second->bytes;
    items_.erase(found->second);
    index_.erase(found);
  }
  items_.push_front({key, std::move(entry), bytes});
  index_[key] = items_.begin();
  bytes_ += bytes;
  while (bytes_ > limit_ && items_.size() > 1) {
    bytes_ -= items_.back().bytes;
    index_.erase(items_.back().key);
    items_.pop_back();
  }
}

std::uint64_t MemoryCache::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void MemoryCache::clear() {
  const std::lock_guard lock(mutex_);
  items_.clear();
  index_.clear();
  bytes_ = 0;
}

}  // namespace frustum
