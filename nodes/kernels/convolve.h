// Weighted sums of rows: one pass of a separable filter. The truth for every Real; simd/convolve.cpp has the
// twin for float, operation by operation.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace frustum::kernels {

/// out[x] = sum over k of weight[k] rows[k][x], in the order of k; where all rows have the same bits at x,
/// these bits, so that a constant stays what it is whatever the weights' rounding.
///   rows  at least one, as many as weights, each of n elements; may overlap each other, not `out`
template <std::floating_point R>
void weigh_rows(std::span<const R* const> rows, std::span<const R> weight, std::size_t n, R* out) {
  using Bits = std::conditional_t<sizeof(R) == 4, std::uint32_t, std::uint64_t>;
  for (std::size_t x = 0; x < n; ++x) {
    const R first = rows[0][x];
    bool same = true;
    R sum = weight[0] * first;
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const R v = rows[k][x];
      same = same && std::bit_cast<Bits>(v) == std::bit_cast<Bits>(first);
      sum = sum + weight[k] * v;
    }
    out[x] = same ? first : sum;
  }
}

}  // namespace frustum::kernels
