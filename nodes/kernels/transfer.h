// Transfer curves of colour spaces, and the change from one space to another: decode, matrix, encode. The
// truth for every Real; simd/transfer.h has the twin for float, operation by operation.
//
// Curves are odd: a negative value is the negative of its magnitude's image, so that colours outside a gamut
// survive a round trip. NaN stays NaN, infinity infinity.
#pragma once

#include "nodes/kernels/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>

namespace frustum::kernels {

enum class Curve : std::uint8_t {
  linear,
  srgb,       ///< IEC 61966-2-1: two pieces that meet at 0.0031308 with a step of 3e-8; also Display P3
  rec709,     ///< BT.709 and BT.2020 camera curve, with the constants that make it smooth
  adobe_rgb,  ///< exponent 563/256, Adobe RGB (1998) section 4.3.1.2
};

/// encoded = slope v up to `knee`, scale v^(1/gamma) - (scale - 1) above: 1 is encoded as 1.
struct CurveShape {
  double gamma, scale, slope, knee;
};
constexpr CurveShape shape_of(Curve c) {
  switch (c) {
    case Curve::srgb: return {2.4, 1.055, 12.92, 0.0031308};
    // The solution of scale knee^0.45 - (scale - 1) = slope knee, 0.45 scale knee^-0.55 = slope.
    case Curve::rec709: return {1 / 0.45, 1.09929682680944, 4.5, 0.018053968510807};
    case Curve::adobe_rgb: return {563.0 / 256, 1, 0, -1};
    case Curve::linear: break;
  }
  return {1, 1, 1, 0};
}

/// The constants in Real, so that scalar and vector code use the same ones. `rest` is what the rounding of
/// scale left out; with it 1 is a fixed point, and the difference near the knee keeps its digits; above 1 it does not matter.
template <std::floating_point R>
struct CurveIn {
  R power, scale, rest, offset, slope, knee;
};
template <std::floating_point R>
constexpr CurveIn<R> encoder(Curve c) {
  const CurveShape s = shape_of(c);
  const R scale = static_cast<R>(s.scale);
  return {static_cast<R>(1 / s.gamma),
          scale,
          static_cast<R>(s.scale - static_cast<double>(scale)),
          static_cast<R>(s.scale - 1),
          static_cast<R>(s.slope),
          static_cast<R>(s.knee)};
}
/// sRGB decodes linearly up to 0.04045, the standard's own rounding of the image of the knee.
template <std::floating_point R>
constexpr CurveIn<R> decoder(Curve c) {
  const CurveShape s = shape_of(c);
  const double knee = c == Curve::srgb ? 0.04045 : s.knee < 0 ? -1 : s.knee * s.slope;
  return {static_cast<R>(s.gamma),
          static_cast<R>(s.scale),
          0,
          static_cast<R>(s.scale - 1),
          static_cast<R>(s.slope > 0 ? 1 / s.slope : 0),
          static_cast<R>(knee)};
}

/// The curved piece is nowhere below the end of the straight one: the standard's constants make sRGB step
/// down by 3e-8 at the joint, and a ramp would not be monotonic there (hard case COL-07).
template <std::floating_point R>
R not_below_joint(const CurveIn<R>& k, R curved) {
  const R joint = k.knee * k.slope;
  return curved < joint ? joint : curved;
}

/// Linear to encoded, and back; 0 and 1 are fixed points. Relative error in float below 4e-7, in double below
/// 4e-16 plus that of the curve's own condition at the offset.
template <std::floating_point R>
R encode(Curve c, R v) {
  if (c == Curve::linear) return v;
  const CurveIn<R> k = encoder<R>(c);
  const R a = std::abs(v);
  if (a <= k.knee) return std::copysign(a * k.slope, v);
  const R p = kernels::pow(a, k.power);
  return std::copysign(not_below_joint(k, p * k.scale + (std::min(p, R(1)) * k.rest - k.offset)), v);
}
template <std::floating_point R>
R decode(Curve c, R v) {
  if (c == Curve::linear) return v;
  const CurveIn<R> k = decoder<R>(c);
  const R a = std::abs(v);
  if (a <= k.knee) return std::copysign(a * k.slope, v);
  return std::copysign(not_below_joint(k, kernels::pow((a + k.offset) / k.scale, k.power)), v);
}

/// From one colour space to another.
struct ColorMap {
  Curve from = Curve::linear, to = Curve::linear;
  bool same_primaries = true;                               ///< the matrix is the identity and left out
  bool keeps_grey = false;                                  ///< its rows sum to 1
  std::array<double, 9> matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
};

/// One row of the matrix, m, on a colour whose component of that row is x and whose others are y and z, with
/// weights my and mz. Where rows sum to 1, greys keep their bits: only differences are weighed.
template <std::floating_point R>
R mixed(R x, R y, R z, R my, R mz) {
  return x + (my * (y - x) + mz * (z - x));
}

/// Converts n pixels in place; the three rows do not overlap. An infinite component may make the others NaN.
template <std::floating_point R>
void convert_colors(const ColorMap& map, R* r, R* g, R* b, std::size_t n) {
  std::array<R, 9> m{};
  for (std::size_t i = 0; i < 9; ++i) m[i] = static_cast<R>(map.matrix[i]);
  for (std::size_t i = 0; i < n; ++i) {
    std::array<R, 3> c{decode(map.from, r[i]), decode(map.from, g[i]), decode(map.from, b[i])};
    if (map.keeps_grey)
      c = {mixed(c[0], c[1], c[2], m[1], m[2]), mixed(c[1], c[0], c[2], m[3], m[5]),
           mixed(c[2], c[0], c[1], m[6], m[7])};
    else if (!map.same_primaries)
      c = {m[0] * c[0] + m[1] * c[1] + m[2] * c[2], m[3] * c[0] + m[4] * c[1] + m[5] * c[2],
           m[6] * c[0] + m[7] * c[1] + m[8] * c[2]};
    r[i] = encode(map.to, c[0]), g[i] = encode(map.to, c[1]), b[i] = encode(map.to, c[2]);
  }
}

}  // namespace frustum::kernels
