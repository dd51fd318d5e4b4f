// A texture of noise, row by row.
#pragma once

#include "nodes/kernels/noise.h"

#include <algorithm>

namespace frustum::texture {

struct NoiseLook {
  kernels::Octaves octaves;
  double scale = 4, contrast = 2;
  bool bounded = true;
};

/// The mix, in [0, 1], of two colours at each of n points: octaves of noise at scale * place, times the
/// contrast, from low at -1 (0 where they are turbulent) to high at 1. `bounded` fades out what a pixel cannot
/// resolve, whose width is the longer of its two derivatives. 0 where nothing is seen.
template <std::floating_point R>
void noise_row(const NoiseLook& look, const kernels::PlaceRows<R>& in, std::size_t n, R* mix) {
  const R scale = static_cast<R>(look.scale), contrast = static_cast<R>(look.contrast);
  for (std::size_t i = 0; i < n; ++i) {
    mix[i] = 0;
    if (!in.covers(i)) continue;
    auto p = in.row(in.at, i);
    for (R& x : p) x *= scale;
    const R along_x = kernels::length_of(in.row(in.by_x, i)),
            along_y = kernels::length_of(in.row(in.by_y, i));
    const R width = look.bounded ? std::max(along_x, along_y) * scale : R(0);
    const R sum = contrast * kernels::octave_sum(look.octaves, p, width);
    const R share = look.octaves.turbulent ? sum : R(0.5) + R(0.5) * sum;
    mix[i] = share > R(0) ? (share < R(1) ? share : R(1)) : R(0);
  }
}

}  // namespace frustum::texture
