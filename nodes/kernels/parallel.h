#pragma once
// Loops over blocks of fixed size: what each block does depends on its number alone, so that any number of
// threads gives the same bytes.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace frustum::kernels {

// Calls call(body, k) for every k below n, in parallel. What a call throws comes out, and those not yet begun are
// left.
void parallel_calls(std::size_t n, void (*call)(const void* body, std::size_t k), const void* body);

// Calls body(k) for every k below n, each as its own task.
template <class Body>
void parallel_each(std::size_t n, const Body& body) {
  parallel_calls(
      n, [](const void* b, std::size_t k) { (*static_cast<const Body*>(b))(k); }, &body);
}

// Calls body(begin, end) for [0, block), [block, 2 block), ... below n; in parallel where there is more than
// one. What a body throws comes out, and blocks not yet begun are left.
template <class Body>
void parallel_blocks(std::size_t n, std::size_t block, const Body& body) {
  if (n <= block) {
    if (n > 0) body(std::size_t{0}, n);
    return;
  }
  parallel_each((n + block - 1) / block,
                [&](std::size_t k) { body(k * block, std::min(n, (k + 1) * block)); });
}

// Elements of the usual block: enough work to hide the cost of handing it over.
inline constexpr std::size_t usual_block = 16384;

// The i < n whose flag mark(begin, end, flags) sets in flags[i - begin], ascending; `mark` is called for
// blocks of at most usual_block, from any thread, and fills its whole block with 0 or 1.
template <class Mark>
std::vector<std::uint32_t> indices_marked(std::size_t n, const Mark& mark) {
  const std::size_t blocks = (n + usual_block - 1) / usual_block;
  const auto found = std::make_unique_for_overwrite<std::uint32_t[]>(n);
  std::vector<std::size_t> first(blocks + 1, 0);
  parallel_blocks(n, usual_block, [&](std::size_t begin, std::size_t end) {
    const auto flags = std::make_unique_for_overwrite<std::uint8_t[]>(end - begin);
    mark(begin, end, flags.get());
    std::size_t at = begin;
    for (std::size_t i = begin; i < end; ++i) {
      found[at] = static_cast<std::uint32_t>(i);
      at += flags[i - begin];  // without a branch: kept and dropped faces come in no order
    }
    first[begin / usual_block + 1] = at - begin;
  });
  for (std::size_t k = 0; k < blocks; ++k) first[k + 1] += first[k];
  std::vector<std::uint32_t> kept(first[blocks]);
  parallel_blocks(n, usual_block, [&](std::size_t begin, std::size_t) {
    const std::size_t k = begin / usual_block;
    std::copy_n(found.get() + begin, first[k + 1] - first[k],
                kept.begin() + static_cast<std::ptrdiff_t>(first[k]));
  });
  return kept;
}

// The i < n for which keep(i), ascending. `keep` may be called from any thread.
template <class Keep>
std::vector<std::uint32_t> indices_where(std::size_t n, const Keep& keep) {
  return indices_marked(n, [&keep](std::size_t begin, std::size_t end, std::uint8_t* flags) {
    for (std::size_t i = begin; i < end; ++i) flags[i - begin] = keep(i) ? 1 : 0;
  });
}

// The least i < n for which holds(i), or n where there is none. Blocks beyond one that was found are not begun.
// `holds` may be called from any thread.
template <class Holds>
std::size_t first_where(std::size_t n, const Holds& holds) {
  std::atomic<std::size_t> first{n};
  parallel_blocks(n, usual_block, [&](std::size_t begin, std::size_t end) {
    if (begin > first.load(std::memory_order_relaxed)) return;
    std::size_t i = begin;
    while (i < end && !holds(i)) ++i;
    if (i == end) return;
    for (std::size_t seen = first; i < seen && !first.compare_exchange_weak(seen, i);) {
    }
  });
  return first;
}

}  // namespace frustum::kernels
