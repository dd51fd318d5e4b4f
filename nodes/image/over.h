// One picture over another.
#pragma once

#include <concepts>
#include <cstddef>

namespace frustum::image {

// to = over + (1 - alpha) under, for one premultiplied plane of a row; alpha may be null (opaque), under a
// row or null for the constant. A sample of alpha 1 keeps the bits of `over`, one of alpha 0 and colour 0
// those of `under`, wherever they are finite. Cost: two operations a number.
// Source: Porter & Duff 1984, "Compositing digital images", doi:10.1145/964965.808606.
template <std::floating_point R>
void over_row(const R* over, const R* alpha, const R* under, R constant, std::size_t n, R* to) {
  for (std::size_t x = 0; x < n; ++x) {
    const R below = under != nullptr ? under[x] : constant;
    to[x] = alpha != nullptr ? over[x] + (1 - alpha[x]) * below : over[x];
  }
}

}  // namespace frustum::image
