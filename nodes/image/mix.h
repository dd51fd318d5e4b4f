// Between one picture and another.
#pragma once

#include <concepts>
#include <cstddef>

namespace frustum::image {

// to = a + w (b - a), for one plane of a row: w is share[x] times amount, or amount alone. Where w is 0 that is a, and where
// it is 1 b, bit for bit, whatever the other holds. Cost: four operations a number.
template <std::floating_point R>
void mix_row(const R* a, const R* b, const R* share, R amount, std::size_t n, R* to) {
  for (std::size_t x = 0; x < n; ++x) {
    const R w = share != nullptr ? share[x] * amount : amount;
    to[x] = w == 0 ? a[x] : w == 1 ? b[x] : a[x] + w * (b[x] - a[x]);
  }
}

}  // namespace frustum::image
