// Colours without their strength.
#pragma once

#include <array>
#include <cmath>
#include <concepts>

namespace frustum::kernels {

template <std::floating_point R>
struct Chromaticity {
  std::array<R, 3> part;  // their sum is 1 to within 8 u (2^-53 or 2^-24), where defined
  bool defined;
};

// The point of the plane a + b + c = 1 on the line through the origin and (a, b, c): each number over their sum.
// Not defined where the sum is 0, as for black, or not a number; `part` is then `fallback`. A sum below 0 has the
// point of its opposite. Numbers that are tiny or huge lose nothing: they are scaled by powers of 2 first. Error of
// each part: 3 units in the last place times (|a| + |b| + |c|) / |a + b + c|, which is 1 without negative numbers.
template <std::floating_point R>
Chromaticity<R> chromaticity(const std::array<R, 3>& v, const std::array<R, 3>& fallback) {
  const R greatest = std::fmax(std::fmax(std::abs(v[0]), std::abs(v[1])), std::abs(v[2]));
  const R scale = greatest > R(0x1p100) ? R(0x1p-100) : greatest < R(0x1p-60) ? R(0x1p80) : R(1);
  const std::array<R, 3> s{v[0] * scale, v[1] * scale, v[2] * scale};
  const R sum = (s[0] + s[1]) + s[2];
  if (!(sum < 0 || sum > 0) || std::isinf(sum)) {
    const bool number = sum == 0;
    return {number ? fallback : std::array<R, 3>{sum - sum, sum - sum, sum - sum}, false};
  }
  return {{s[0] / sum, s[1] / sum, s[2] / sum}, true};
}

}  // namespace frustum::kernels
