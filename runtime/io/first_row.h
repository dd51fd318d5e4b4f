// Where something is wrong first, when many threads look.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>

namespace frustum {

// The first row of a range that something is wrong with, found in parallel.
class FirstRow {
 public:
  void offer(std::size_t row) {
    std::size_t now = first_.load(std::memory_order_relaxed);
    while (row < now && !first_.compare_exchange_weak(now, row, std::memory_order_relaxed)) {
    }
  }
  std::optional<std::size_t> row() const {
    return first_ == none ? std::nullopt : std::optional(first_.load());
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};
  std::atomic<std::size_t> first_{none};
};

}  // namespace frustum
