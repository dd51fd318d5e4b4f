// A checkerboard, at a point and averaged over a box without error.
#pragma once

#include <cmath>
#include <concepts>

namespace frustum::kernels {

/// +1 where floor(x) is even, -1 where it is odd: the wave of one row of squares of side 1. NaN and infinity
/// give +1.
template <std::floating_point R>
R square_wave(R x) {
  const R half = x * R(0.5);
  return half - std::floor(half) >= R(0.5) ? R(-1) : R(1);
}

/// The integral of square_wave from 0 to x: a triangle wave, even in x, in [0, 1]. Exact: |x| - 2 floor(|x| /
/// 2) is a multiple of x's last place below 2, and 2 - r is exact for r in [1, 2]. NaN for NaN and infinity.
template <std::floating_point R>
R triangle_wave(R x) {
  const R positive = std::abs(x);
  const R r = positive - R(2) * std::floor(positive * R(0.5));
  return r <= R(1) ? r : R(2) - r;
}

/// The mean of square_wave over [x - half, x + half], in [-1, 1]: two roundings, and exactly +-1 where the
/// interval lies in one square. The value at x where the interval has no length; 0 where its ends are not
/// finite.
template <std::floating_point R>
R square_wave_mean(R x, R half) {
  const R a = x - half, b = x + half;
  if (!(a < b)) return a == b ? square_wave(x) : R(0);
  const R mean = (triangle_wave(b) - triangle_wave(a)) / (b - a);
  return mean == mean ? mean : R(0);
}

/// The share of even squares in a box of the checkerboard whose square (i, j) is even where i + j is: with
/// the squares +-1, the board is the product of two waves and its box mean the product of two means.
template <std::floating_point R>
R even_share(R mean_u, R mean_v) {
  return R(0.5) + R(0.5) * (mean_u * mean_v);
}

}  // namespace frustum::kernels
