// Which bytes are live: storage that several buffers share counts once.
#pragma once

#include "runtime/core/buffer.h"

#include <cstdint>
#include <mutex>
#include <unordered_map>

namespace frustum {

class Ledger {
 public:
  void add(const Buffer& b) { change(b, +1); }
  void remove(const Buffer& b) { change(b, -1); }
  void add_bytes(std::uint64_t n) {
    const std::lock_guard lock(mutex_);
    raise(n);
  }
  void remove_bytes(std::uint64_t n) {
    const std::lock_guard lock(mutex_);
    live_ -= n;
  }
  std::uint64_t live() const {
    const std::lock_guard lock(mutex_);
    return live_;
  }
  std::uint64_t peak() const {
    const std::lock_guard lock(mutex_);
    return peak_;
  }

 private:
  void raise(std::uint64_t n) {
    live_ += n;
    peak_ = std::max(peak_, live_);
  }
  void change(const Buffer& b, int by) {
    if (!b) return;
    const std::lock_guard lock(mutex_);
    const auto piece = [&](const void* storage, std::size_t bytes) {
      int& holders = holders_[storage];
      if (by > 0 && holders == 0) raise(bytes);
      holders += by;
      if (holders != 0) return;
      live_ -= bytes;
      holders_.erase(storage);
    };
    if (b.type().parts != nullptr)
      b.type().parts(b.data(), piece);
    else
      piece(b.data(), b.bytes());
  }

  mutable std::mutex mutex_;
  std::unordered_map<const void*, int> holders_;
  std::uint64_t live_ = 0, peak_ = 0;
};

}  // namespace frustum
