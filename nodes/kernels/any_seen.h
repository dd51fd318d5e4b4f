// Whether a row shows anything: what most rows of most pictures do not need to be worked on for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace frustum::kernels {

/// Whether any of n ids is a face's: all bits are set where nothing is seen. O(n), less where much is seen. Blocks of a
/// fixed length vectorise.
inline bool any_seen(const std::uint32_t* id, std::size_t n) {
  constexpr std::size_t block = 64;
  constexpr std::uint32_t nothing = ~0u;
  std::uint32_t all = nothing;
  std::size_t x = 0;
  for (; x + block <= n && all == nothing; x += block)
    for (std::size_t k = 0; k < block; ++k) all &= id[x + k];
  for (; x < n; ++x) all &= id[x];
  return all != nothing;
}

}  // namespace frustum::kernels
