// Layers of colour over one another, from the front to the back.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>

namespace frustum::kernels {

// Rows of premultiplied layers by channel: red, green, blue, alpha. Strides count elements, from a layer to the one
// behind it.
template <std::floating_point R>
struct LayerRows {
  std::array<const R*, 4> first;
  std::array<std::ptrdiff_t, 4> stride;
  int layers;
};

// Puts the layers of each of n samples over one another: sum += through * layer, through *= 1 - alpha, in binary64
// whatever the layers are in, until no light comes through. What lies behind is not looked at, so that a NaN there
// changes nothing.
//   out  a row a channel; null where nobody reads it
//
// For n layers of binary32 and |alpha| in [0, 1] the relative error of every sum of terms of one sign is below
// 2 n 2^-53 before it is rounded to binary32: 1 - a of a binary32 a is exact where a >= 2^-29, and is off by half an
// ulp of 1 at most below that; each product and each sum adds one rounding. So up to 2^27 layers both directions of
// compositing agree to the last bit or its neighbour. A layer of alpha 1 ends the list exactly: through is 0. A layer
// of colour and alpha 0 leaves every bit. One layer alone keeps its bits, but for -0, which becomes 0.
// Source: Porter & Duff 1984, Compositing digital images, doi:10.1145/964965.808606.
template <std::floating_point R>
void composite_layers(const LayerRows<R>& in, std::size_t n, const std::array<R*, 4>& out) {
  for (std::size_t x = 0; x < n; ++x) {
    std::array<double, 4> sum{};
    double through = 1;
    for (std::ptrdiff_t layer = 0; layer < in.layers && through > 0; ++layer) {
      const auto value = [&](std::size_t c) {
        return static_cast<double>(in.first[c][layer * in.stride[c] + static_cast<std::ptrdiff_t>(x)]);
      };
      for (std::size_t c = 0; c < 4; ++c) sum[c] += through * value(c);
      through = through * (1 - value(3));
    }
    for (std::size_t c = 0; c < 4; ++c)
      if (out[c] != nullptr) out[c][x] = static_cast<R>(sum[c]);
  }
}

}  // namespace frustum::kernels
