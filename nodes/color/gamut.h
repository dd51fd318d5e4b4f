// What three primaries can show, and what is put in the place of the rest.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>

namespace frustum::color {

enum class Gamut { light, display };
enum class Mapping { clip, desaturate };

// Whether a linear colour of the primaries is a mixture of them: no part is below 0 (and none above 1 for a
// display). The parts have the signs of the barycentric coordinates of the colour's chromaticity in the triangle
// of the primaries, since each is its coordinate times what is positive: (X + Y + Z) of the colour over that of the
// primary. So the mixture is convex, not only affine (errata E56). Exact for the numbers given; -0 is inside, NaN
// is not.
template <std::floating_point R>
bool inside(const std::array<R, 3>& rgb, Gamut of) {
  const auto in = [&](R v) { return v >= 0 && (of == Gamut::light || v <= 1); };
  return in(rgb[0]) && in(rgb[1]) && in(rgb[2]);
}

// A colour inside for one outside; those inside keep every bit, so that twice is once. `clip` takes the nearest
// point: each part is cut for itself, which is the projection on a convex set and changes hue and luminance.
// `desaturate` goes towards the grey of the same luminance as far as it has to, so luminance (cut to what the gamut
// has) and the line to white in the chromaticity diagram stay. `weights`: luminance of the primaries; their sum is
// 1. NaN stays NaN. Error of desaturate: 8 u of the greatest magnitude.
template <std::floating_point R>
std::array<R, 3> mapped(const std::array<R, 3>& rgb, Gamut of, Mapping how, const std::array<R, 3>& weights) {
  if (inside(rgb, of)) return rgb;
  const auto cut = [&](R v) { return v < 0 ? R(0) : of == Gamut::display && v > 1 ? R(1) : v; };
  if (how == Mapping::clip) return {cut(rgb[0]), cut(rgb[1]), cut(rgb[2])};
  const R grey = cut((weights[0] * rgb[0] + weights[1] * rgb[1]) + weights[2] * rgb[2]);
  R share = 1;  // of the way from grey to the colour; grey is inside
  for (const R v : rgb) {
    if (v < 0) share = std::fmin(share, grey / (grey - v));
    if (of == Gamut::display && v > 1) share = std::fmin(share, (1 - grey) / (v - grey));
  }
  std::array<R, 3> to{};
  for (std::size_t c = 0; c < 3; ++c) to[c] = cut(grey + share * (rgb[c] - grey));
  return to;
}

}  // namespace frustum::color
