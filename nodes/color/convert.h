// Colours with and without their coverage.
#pragma once

#include <concepts>
#include <cstddef>

namespace frustum {

// Divides n premultiplied values by their alpha, and multiplies them again. Where alpha is not above zero
// (NaN included) there is nothing to divide by and the value stays: light without coverage, such as a glow,
// is converted as it is. The way there and back errs by at most one unit in the last place; where alpha is
// 1 by nothing.
template <std::floating_point R>
void divide_by_alpha(const R* alpha, R* values, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) values[i] = alpha[i] > 0 ? values[i] / alpha[i] : values[i];
}
template <std::floating_point R>
void multiply_by_alpha(const R* alpha, R* values, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) values[i] = alpha[i] > 0 ? values[i] * alpha[i] : values[i];
}

}  // namespace frustum
