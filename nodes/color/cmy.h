// Inks that take light away from white paper.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>

namespace frustum::color {

// How much of cyan, magenta and yellow leaves this colour of white: 1 - r, 1 - g, 1 - b. Numbers outside of [0, 1]
// go on along the line: a colour above 1 takes less than no ink. Its own inverse: what comes back differs from
// the colour by at most u (half a unit in the last place of 1), and by nothing where it is a multiple of 2 u.
template <std::floating_point R>
std::array<R, 3> complement(const std::array<R, 3>& v) {
  return {1 - v[0], 1 - v[1], 1 - v[2]};
}

// The same with the part of all three replaced by black: k = min(c, m, y) = 1 - most, most the greatest of r, g and
// b, and (c - k) / (1 - k) = (most - r) / most of the rest. most is kept within [0, 1]: colours above 1 take no black
// and less than no ink. Where it is 0, k is 1 and the others are 0 (hard case COL-12), also for colours below black,
// which ink has nothing for. One NaN makes four.
template <std::floating_point R>
std::array<R, 4> cmyk_of_rgb(const std::array<R, 3>& rgb) {
  if (std::isnan(rgb[0]) || std::isnan(rgb[1]) || std::isnan(rgb[2])) {
    constexpr R nan = std::numeric_limits<R>::quiet_NaN();
    return {nan, nan, nan, nan};
  }
  const R most = std::clamp(std::max(std::max(rgb[0], rgb[1]), rgb[2]), R(0), R(1));
  if (most == 0) return {R(0), R(0), R(0), R(1)};
  return {(most - rgb[0]) / most, (most - rgb[1]) / most, (most - rgb[2]) / most, 1 - most};
}

// The colour that four inks leave: (1 - c)(1 - k). Comes back to within 4 u where the colour is in [0, 1].
template <std::floating_point R>
std::array<R, 3> rgb_of_cmyk(const std::array<R, 4>& ink) {
  return {(1 - ink[0]) * (1 - ink[3]), (1 - ink[1]) * (1 - ink[3]), (1 - ink[2]) * (1 - ink[3])};
}

}  // namespace frustum::color
