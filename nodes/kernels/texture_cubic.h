// Bicubic interpolation between texels: sharper than bilinear, or smoother.
#pragma once

#include "nodes/kernels/filter.h"
#include "nodes/kernels/texture_texels.h"

#include <array>

namespace frustum::kernels {

/// Of the family of Mitchell & Netravali 1988: (1/3, 1/3) theirs, (0, 1/2) Catmull-Rom, which interpolates,
/// (1, 0) the B-spline, which is twice differentiable and blurs.
struct Cubic {
  double b, c;
};

template <std::floating_point R>
class CubicCurve {
 public:
  explicit CubicCurve(const Cubic& c)
      : curve_({.kind = FilterKind::mitchell, .radius = 2, .sigma = 0, .b = c.b, .c = c.c}) {}
  /// The weights of the texels before, at and two after, for a place `fraction` in [0, 1) behind `at`; their
  /// sum is 1 but for rounding.
  std::array<R, 4> weights(R fraction) const {
    return {curve_(R(1) + fraction), curve_(fraction), curve_(R(1) - fraction), curve_(R(2) - fraction)};
  }

 private:
  FilterCurve<R> curve_;
};

/// The sixteen texels around a placed (s, t), as differences to one of them: equal texels give their bits,
/// and Catmull-Rom gives a texel's bits at its middle. May leave the texels' range by a fifth of it (not the
/// B-spline).
template <std::floating_point R>
Rgba<R> bicubic(const TexelPyramid& p, const TexelLevel& level, const CubicCurve<R>& curve, R s, R t) {
  const R x = s * static_cast<R>(level.width) - R(0.5), y = t * static_cast<R>(level.height) - R(0.5);
  const R left = std::floor(x), top = std::floor(y);
  const auto across = curve.weights(x - left), down = curve.weights(y - top);
  std::array<int, 4> column;
  for (std::size_t i = 0; i < 4; ++i)
    column[i] = wrapped(static_cast<int>(left) - 1 + static_cast<int>(i), level.width, p.wrap_u);
  const Rgba<R> base = texel<R>(level, column[1], wrapped(static_cast<int>(top), level.height, p.wrap_v));
  Rgba<R> sum{};
  for (std::size_t j = 0; j < 4; ++j) {
    const int row = wrapped(static_cast<int>(top) - 1 + static_cast<int>(j), level.height, p.wrap_v);
    Rgba<R> part{};
    for (std::size_t i = 0; i < 4; ++i) {
      const Rgba<R> c = texel<R>(level, column[i], row);
      for (std::size_t k = 0; k < 4; ++k) part[k] += across[i] * (c[k] - base[k]);
    }
    for (std::size_t k = 0; k < 4; ++k) sum[k] += down[j] * part[k];
  }
  for (std::size_t k = 0; k < 4; ++k) sum[k] += base[k];
  return sum;
}

}  // namespace frustum::kernels
