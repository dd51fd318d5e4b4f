// How bright a colour is.
#pragma once

#include <array>
#include <concepts>

namespace frustum::color {

// The Y of CIE XYZ of a linear colour: a weighted sum of its parts, whose weights are the luminances of the
// primaries and add up to 1 (that of white). Negative parts count negatively. Error: 3 u of the sum of magnitudes.
template <std::floating_point R>
R luminance(const std::array<R, 3>& linear, const std::array<R, 3>& weights) {
  return (weights[0] * linear[0] + weights[1] * linear[1]) + weights[2] * linear[2];
}

}  // namespace frustum::color
