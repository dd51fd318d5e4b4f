// A texture of marble, row by row: layers bent by turbulence.
#pragma once

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/noise.h"

#include <algorithm>
#include <numbers>

namespace frustum::texture {

struct Marble {
  std::array<double, 3> axis{1, 0, 0};  ///< across the layers; its length scales their number
  double scale = 1, bend = 1;           ///< cycles a unit; how many cycles turbulence moves them
  kernels::Octaves octaves;
};

/// sin x / x.
template <std::floating_point R>
R sinc(R x) {
  return std::abs(x) < R(1e-4) ? R(1) : kernels::sin(x) / x;
}

/// The mix, in [0, 1], of two colours at each of n points: 1/2 + 1/2 sin(2 pi (axis . p scale + bend
/// turbulence(p scale))). With `bounded` the layers are averaged over the pixel as if the phase were linear
/// there, which multiplies the sine by the sinc of half its change along x and along y, and turbulence fades
/// as in noise_row. 0 where nothing is seen. Source: Perlin 1985, An Image Synthesizer,
/// doi:10.1145/325165.325247 (the formula).
template <std::floating_point R>
void marble_row(const Marble& m, bool bounded, const kernels::PlaceRows<R>& in, std::size_t n, R* mix) {
  const R scale = static_cast<R>(m.scale);
  const auto across = [&](const std::array<R, 3>& v) {
    return scale * (static_cast<R>(m.axis[0]) * v[0] + static_cast<R>(m.axis[1]) * v[1] +
                    static_cast<R>(m.axis[2]) * v[2]);
  };
  for (std::size_t i = 0; i < n; ++i) {
    mix[i] = 0;
    if (!in.covers(i)) continue;
    const auto at = in.row(in.at, i), by_x = in.row(in.by_x, i), by_y = in.row(in.by_y, i);
    const R width = bounded ? std::max(kernels::length_of(by_x), kernels::length_of(by_y)) * scale : R(0);
    const R turbulence = kernels::octave_sum(m.octaves, {at[0] * scale, at[1] * scale, at[2] * scale}, width);
    const R cycles = across(at) + static_cast<R>(m.bend) * turbulence, phase = cycles - std::floor(cycles);
    R wave = kernels::sin(R(2 * std::numbers::pi) * phase);
    if (bounded) wave *= sinc(R(std::numbers::pi) * across(by_x)) * sinc(R(std::numbers::pi) * across(by_y));
    const R share = R(0.5) + R(0.5) * wave;
    mix[i] = share > R(0) ? (share < R(1) ? share : R(1)) : R(0);
  }
}

}  // namespace frustum::texture
