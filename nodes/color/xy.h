// Chromaticity and luminance of tristimulus values.
#pragma once

#include "nodes/kernels/chromaticity.h"

namespace frustum::color {

// x = X / (X + Y + Z), y = Y / (X + Y + Z), and Y. Where the sum is 0, as for black, x and y are those of `white`.
// Source: CIE 15:2018, 7.3.
template <std::floating_point R>
std::array<R, 3> xyy_of_xyz(const std::array<R, 3>& xyz, const std::array<R, 2>& white) {
  const auto c = kernels::chromaticity<R>(xyz, {white[0], white[1], 0});
  return {c.part[0], c.part[1], xyz[1]};
}
template <std::floating_point R>
bool has_xy(const std::array<R, 3>& xyz) {
  return kernels::chromaticity<R>(xyz, {}).defined;
}

// X = x Y / y, Z = (1 - x - y) Y / y: exactly 0 where Y is 0. Infinite where y alone is 0: no light that one sees
// has this chromaticity.
template <std::floating_point R>
std::array<R, 3> xyz_of_xyy(const std::array<R, 3>& v) {
  const R luminance = v[2];
  if (luminance == 0) return {R(0), R(0), R(0)};
  return {v[0] * luminance / v[1], luminance, ((1 - v[0]) - v[1]) * luminance / v[1]};
}

}  // namespace frustum::color
