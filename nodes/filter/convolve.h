// Convolution with a separable kernel: its taps, what lies beyond the picture, and one pass over a row.
#pragma once

#include "nodes/kernels/filter.h"
#include "nodes/kernels/simd/convolve.h"
#include "nodes/kernels/sum.h"

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace frustum::convolution {

enum class Border : std::uint8_t { clamp, zero, mirror, repeat };
constexpr auto choices(Border) {
  return std::array{std::pair{Border::clamp, "clamp"}, std::pair{Border::zero, "zero"},
                    std::pair{Border::mirror, "mirror"}, std::pair{Border::repeat, "repeat"}};
}

/// Weights at -m ... m pixels, even about 0, each divided by their sum. A kernel that is half open at its
/// radius (the box) counts half at both ends, so that a box of radius 1 is 1/4, 1/2, 1/4: its exact coverage
/// of pixels.
template <std::floating_point R>
std::vector<R> symmetric_taps(const kernels::Filter& filter) {
  const kernels::FilterCurve<R> curve(filter);
  int m = static_cast<int>(std::ceil(filter.radius));
  const auto at = [&](int i) { return (curve(static_cast<R>(i)) + curve(static_cast<R>(-i))) / R(2); };
  while (m > 0 && at(m) == R(0)) --m;
  std::vector<R> taps;
  for (int i = -m; i <= m; ++i) taps.push_back(at(i));
  kernels::CompensatedSum<R> sum;
  for (const R w : taps) sum.add(w);
  for (R& w : taps) w /= sum.value();  // not normalize_weights, whose correction of one tap would not be even
  return taps;
}

/// Where the value at index i of a line [low, high) is read; -1 - low is never an index: no_index says
/// "zero".
inline constexpr int no_index = -0x7FFFFFFF;
inline int border_index(int i, int low, int high, Border border) {
  if (i >= low && i < high) return i;
  const std::int64_t size = std::int64_t{high} - low, from_low = std::int64_t{i} - low;
  const auto modulo = [](std::int64_t a, std::int64_t b) { return ((a % b) + b) % b; };
  switch (border) {
    case Border::zero: return no_index;
    case Border::clamp: return i < low ? low : high - 1;
    case Border::repeat: return low + static_cast<int>(modulo(from_low, size));
    case Border::mirror: break;  // d c b a | a b c d | d c b a
  }
  const std::int64_t m = modulo(from_low, 2 * size);
  return low + static_cast<int>(m < size ? m : 2 * size - 1 - m);
}

/// One pass: the vector kernel for float, its scalar twin for double.
template <std::floating_point R>
void weigh_rows(std::span<const R* const> rows, std::span<const R> weight, std::size_t n, R* out) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::weigh_rows(rows, weight, n, out);
  else
    kernels::weigh_rows(rows, weight, n, out);
}

}  // namespace frustum::convolution
