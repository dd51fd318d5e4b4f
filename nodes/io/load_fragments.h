// The order of fragments in a deep picture, whose file need not have them in any.
#pragma once

#include "runtime/buffers/fragments.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

namespace frustum {

// Z from the nearest to the farthest; NaN lies behind everything.
inline bool is_nearer(float a, float b) { return std::isnan(b) ? !std::isnan(a) : a < b; }

// The fragments of every list by ascending Z, equal ones as they were; `unsorted` counts the lists that this changed.
// Without a real channel Z nothing changes. Cost: O(n), and O(k log k) for a list of k that changes.
inline Fragments in_order_of_depth(Fragments f, std::uint64_t& unsorted) {
  unsorted = 0;
  const Column* depth = f.find("Z");
  if (depth == nullptr || depth->kind() != NumberKind::f32) return f;
  const auto z = depth->values<float>();
  std::vector<std::uint64_t> order(f.count());
  std::iota(order.begin(), order.end(), std::uint64_t{0});
  const auto nearer = [&](std::uint64_t a, std::uint64_t b) { return is_nearer(z[a], z[b]); };
  for (std::size_t list = 0; list < f.lists(); ++list) {
    const auto begin = order.begin() + static_cast<std::ptrdiff_t>(f.first[list]),
               end = order.begin() + static_cast<std::ptrdiff_t>(f.first[list + 1]);
    if (std::is_sorted(begin, end, nearer)) continue;
    ++unsorted;
    std::stable_sort(begin, end, nearer);
  }
  if (unsorted == 0) return f;
  for (Ref<Column>& c : f.channels) {
    const std::size_t size = bytes_of(c->kind());
    auto moved = std::make_shared<Column>(c->name(), c->domain(), c->kind(), 1, c->rows());
    const auto* from = static_cast<const std::byte*>(c->data());
    auto* to = static_cast<std::byte*>(moved->data());
    for (std::size_t i = 0; i < order.size(); ++i) std::memcpy(to + i * size, from + order[i] * size, size);
    c = std::move(moved);
  }
  return f;
}

// Lists in which a fragment's range of depths reaches behind where the next one begins.
inline std::uint64_t overlapping_lists(const Fragments& f) {
  const Column *front = f.find("Z"), *back = f.find("ZBack");
  if (front == nullptr || back == nullptr || !front->holds<float>() || !back->holds<float>()) return 0;
  const auto z = front->values<float>(), z_back = back->values<float>();
  std::uint64_t n = 0;
  for (std::size_t list = 0; list < f.lists(); ++list) {
    const auto [begin, end] = f.of_list(list);
    bool any = false;
    for (std::size_t k = begin; k + 1 < end && !any; ++k) any = z_back[k] > z[k + 1];
    n += any ? 1 : 0;
  }
  return n;
}

}  // namespace frustum
