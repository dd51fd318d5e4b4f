// Colours with and without their coverage.
#pragma once

#include <concepts>
#include <cstddef>

namespace frustum {

// Coverage below this is none: quotients of values up to 2^63 stay finite in float (hard case ZBF-09).
inline constexpr double least_alpha = 0x1p-64;

// Divides n premultiplied values by their alpha, and multiplies them again. Where alpha is below least_alpha
// (or NaN) there is nothing to divide by and the value stays: light without coverage, such as a glow, is
// converted as it is. The way there and back errs by at most one unit in the last place; where alpha is
// 1 by nothing.
template <std::floating_point R>
void divide_by_alpha(const R* alpha, R* values, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i)
    values[i] = alpha[i] >= R(least_alpha) ? values[i] / alpha[i] : values[i];
}
template <std::floating_point R>
void multiply_by_alpha(const R* alpha, R* values, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i)
    values[i] = alpha[i] >= R(least_alpha) ? values[i] * alpha[i] : values[i];
}

}  // namespace frustum
