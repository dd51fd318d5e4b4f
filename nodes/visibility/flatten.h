// One list of fragments put over one another.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

namespace frustum::flattening {

// Colour and alpha of fragments by channel: red, green, blue, alpha, premultiplied. Null: 0, and opaque for alpha.
template <std::floating_point R>
using Channels = std::array<const R*, 4>;

// The fragments [begin, end) from the front to the back, as kernels::composite_layers sums them, with its bounds: in
// binary64, ending at the first of alpha 1.
template <std::floating_point R>
std::array<double, 4> flatten(const Channels<R>& from, std::size_t begin, std::size_t end) {
  std::array<double, 4> sum{};
  double through = 1;
  for (std::size_t i = begin; i < end && through > 0; ++i) {
    const double alpha = from[3] != nullptr ? static_cast<double>(from[3][i]) : 1;
    for (std::size_t c = 0; c < 3; ++c)
      if (from[c] != nullptr) sum[c] += through * static_cast<double>(from[c][i]);
    sum[3] += through * alpha;
    through *= 1 - alpha;
  }
  return sum;
}

}  // namespace frustum::flattening
