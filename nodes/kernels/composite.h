// Layers of colour over one another, from the front to the back.
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>

namespace frustum::kernels {

// What has come together in a row of n samples: premultiplied colour and alpha, and the share of light that still
// comes through. In binary64, whatever the layers are in.
struct CompositeSums {
  std::size_t n;
  double* through;                     // 1 at first
  double *red, *green, *blue, *alpha;  // 0 at first
};

// Puts a layer behind those before it: sum += through * layer, through *= 1 - alpha, for premultiplied colours. Tells
// whether light still comes through anywhere: once it does not, nothing behind changes a bit.
//
// For n layers of binary32 and |alpha| in [0, 1] the relative error of every sum of terms of one sign is below
// 2 n 2^-53 before it is rounded to binary32: 1 - a of a binary32 a is exact where a >= 2^-29, and is off by half an
// ulp of 1 at most below that; each product and each sum adds one rounding. So up to 2^27 layers both directions of
// compositing agree to the last bit or its neighbour. A layer of alpha 1 ends the list exactly: through is 0. A layer
// of colour and alpha 0 leaves every bit. One layer alone keeps its bits, but for -0, which becomes 0.
// Source: Porter & Duff 1984, Compositing digital images, doi:10.1145/964965.808606.
template <std::floating_point R>
bool put_behind(const R* red, const R* green, const R* blue, const R* alpha, const CompositeSums& to) {
  double most = 0;
  for (std::size_t x = 0; x < to.n; ++x) {
    const double through = to.through[x], a = static_cast<double>(alpha[x]);
    to.red[x] += through * static_cast<double>(red[x]);
    to.green[x] += through * static_cast<double>(green[x]);
    to.blue[x] += through * static_cast<double>(blue[x]);
    to.alpha[x] += through * a;
    to.through[x] = through * (1 - a);
    most = std::max(most, to.through[x]);
  }
  return most > 0;
}

}  // namespace frustum::kernels
