// Elliptical weighted averages: a pixel's footprint as it is, long and thin where the surface is seen at a
// slant.
//
// The weights are (1 - q)^2 for q = x^T E^-1 x < 1. Their variance is E / 8, so that
//   E = 8 (J J^T / 12 + I / 6) = (2 G + 4 I) / 3
// has the variance of the pixel's square, a box of 1/12, and of the tent by which texels are interpolated,
// 1/6. Departure from Heckbert's Gaussian of the pixel's circle (variance 1/4 and more, cut off at its tail):
// as sharp as a
// pixel that is supersampled, no step at the edge, and no exponential. Texels of level l come ready averaged
// over their square, which the tent's share more than covers.
// Source: Greene & Heckbert 1986, IEEE CG&A 6(6); Heckbert 1989, section 3.5; the level by the minor axis,
// with two levels blended: Igehy & Pereira; PBRT 3rd ed., 10.4.5.
#pragma once

#include "nodes/kernels/texture_footprint.h"
#include "nodes/kernels/texture_texels.h"

#include <algorithm>

namespace frustum::kernels {

/// Half the minor axis, in texels of the finer of the two levels, lies between 2^this and twice that: raising
/// it looks at finer levels, at four times the texels.
inline constexpr int ewa_detail = 1;

/// The level of the pyramid for a (widened) footprint, in [0, last].
template <std::floating_point R>
R ewa_level(const Footprint<R>& f, int last) {
  const R level = log2_of_footprint(f.minor) - R(ewa_detail), top = static_cast<R>(last);
  return level > R(0) ? (level < top ? level : top) : R(0);
}

/// The texels first ... last of one row of an ellipse, and perhaps one beyond either, whose weight is 0.
template <std::floating_point R>
struct EllipseRow {
  int row, first, last;
  R x, a, b, c;  // 1 - q = 1 - ((a dx + b) dx + c)
  R weight(int column) const {
    const R dx = static_cast<R>(column) - x, left = R(1) - ((a * dx + b) * dx + c);
    return left > R(0) ? left * left : R(0);
  }
};

/// Calls visit(row) for every row of the ellipse E = (ss, st, tt) about (x, y), in texels with middles at
/// whole numbers. Requires a determinant of 1 or more, and places below 2^24.
template <std::floating_point R, class Visit>
void visit_ellipse(R x, R y, R ss, R st, R tt, const Visit& visit) {
  const R det = difference_of_products(ss, tt, st, st), scale = R(1) / det;
  const R a = tt * scale, b = R(-2) * st * scale, c = ss * scale, slope = st / tt, reach = std::sqrt(tt);
  const int bottom = static_cast<int>(std::floor(y + reach));
  for (int j = static_cast<int>(std::ceil(y - reach)); j <= bottom; ++j) {
    const R dy = static_cast<R>(j) - y, middle = x + slope * dy;
    const R half = std::sqrt(std::max(R(0), det * (tt - dy * dy))) / tt;
    visit(EllipseRow<R>{j, static_cast<int>(std::ceil(middle - half)),
                        static_cast<int>(std::floor(middle + half)), x, a, b * dy, c * dy * dy});
  }
}

/// A sum of weighted differences to one colour. simd/texture_lookup.cpp has the twin for float.
template <std::floating_point R>
struct ColorSum {
  explicit ColorSum(const Rgba<R>& from) : base(from) {}
  void add(const float* texel, R w) {
    for (std::size_t k = 0; k < 4; ++k) sum[k] += w * (R(texel[k]) - base[k]);
  }
  Rgba<R> mean(R weights) const {
    Rgba<R> c;
    for (std::size_t k = 0; k < 4; ++k) c[k] = base[k] + sum[k] / weights;
    return c;
  }
  Rgba<R> base, sum{};
};

/// The average of one level over such an ellipse. Equal texels give their bits.
template <class Sum, std::floating_point R>
Rgba<R> ellipse_mean(const TexelPyramid& p, const TexelLevel& level, R x, R y, R ss, R st, R tt) {
  static constexpr float border[4] = {};
  const Rgba<R> base =
      texel<R>(level, wrapped(static_cast<int>(std::floor(x + R(0.5))), level.width, p.wrap_u),
               wrapped(static_cast<int>(std::floor(y + R(0.5))), level.height, p.wrap_v));
  Sum sum(base);
  R weights = 0;
  visit_ellipse(x, y, ss, st, tt, [&](const EllipseRow<R>& row) {
    const int v = wrapped(row.row, level.height, p.wrap_v);
    for (int i = row.first; i <= row.last; ++i) {
      const R w = row.weight(i);
      if (!(w > R(0))) continue;
      const int u = wrapped(i, level.width, p.wrap_u);
      std::array<float, 4> copy;
      sum.add((u | v) < 0 ? border : texel_numbers(level, u, v, copy), w);
      weights += w;
    }
  });
  return weights > R(0) ? sum.mean(weights) : base;
}

/// The colour of point x, added up by a ColorSum<R> or its twin. At most some 50 max_anisotropy texels are
/// read, whatever the derivatives; where their squares are not finite, the last level.
template <class Sum, std::floating_point R>
Rgba<R> elliptical(const TexelPyramid& p, const UvRows<R>& in, std::size_t x, R max_anisotropy) {
  const TexelLevel& base = p.levels[0];
  const int last = static_cast<int>(p.levels.size()) - 1;
  const R width = static_cast<R>(base.width), height = static_cast<R>(base.height);
  Footprint<R> f = widened(footprint(in, x, width, height), max_anisotropy);
  const R s = placed(in.u[x], p.wrap_u), t = R(1) - placed(in.v[x], p.wrap_v);
  if (!(f.major < R(0x1p50))) f = {.ss = 0, .st = 0, .tt = 0, .major = 0, .minor = R(0x1p30), .area = 0};
  const R level = ewa_level(f, last);
  // The last level stands for all beyond it: what is larger there is shrunk, so that its texels are not read
  // in vain.
  const R most = static_cast<R>(std::int64_t{2} << (last + ewa_detail)),
          shrink = f.minor > most ? most / f.minor : R(1);
  return over_levels(level, [&](int l) {
    const TexelLevel& texels = p.level(l);
    // A side that has been one texel for some levels is the same texel however far one looks along it.
    const R least = shrink / static_cast<R>(std::int64_t{1} << l);
    const R sx = std::min(static_cast<R>(texels.width) / width * shrink, least),
            sy = std::min(static_cast<R>(texels.height) / height * shrink, least);
    constexpr R pixel = R(2) / R(3), tent = R(4) / R(3);
    return ellipse_mean<Sum>(p, texels, s * static_cast<R>(texels.width) - R(0.5),
                             t * static_cast<R>(texels.height) - R(0.5), pixel * (f.ss * sx * sx) + tent,
                             pixel * (f.st * sx * sy), pixel * (f.tt * sy * sy) + tent);
  });
}

}  // namespace frustum::kernels
