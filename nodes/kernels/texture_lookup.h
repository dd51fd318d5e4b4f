// Colours of a row of (u, v): from a pyramid of images, or from a checkerboard. The truth for every Real;
// simd/ has the twin for float, operation by operation.
#pragma once

#include "nodes/kernels/checkerboard.h"
#include "nodes/kernels/texture_cubic.h"
#include "nodes/kernels/texture_ewa.h"
#include "nodes/kernels/texture_footprint.h"

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace frustum::kernels {

/// Only nearest and bilinear do without derivatives.
enum class Lookup : std::uint8_t { nearest, bilinear, trilinear, catmull_rom, mitchell, b_spline, ewa };
constexpr auto choices(Lookup) {
  return std::array{std::pair{Lookup::nearest, "nearest"},
                    std::pair{Lookup::bilinear, "bilinear"},
                    std::pair{Lookup::trilinear, "trilinear"},
                    std::pair{Lookup::catmull_rom, "catmull_rom"},
                    std::pair{Lookup::mitchell, "mitchell"},
                    std::pair{Lookup::b_spline, "b_spline"},
                    std::pair{Lookup::ewa, "ewa"}};
}
constexpr bool is_cubic(Lookup l) { return l >= Lookup::catmull_rom && l <= Lookup::b_spline; }

struct Filtering {
  Lookup kind = Lookup::trilinear;
  double max_anisotropy = 16;  ///< of ewa, >= 1

  Filtering() = default;
  constexpr Filtering(Lookup k, double most = 16) : kind(k), max_anisotropy(most) {}
};

constexpr Cubic cubic_of(Lookup l) {
  return l == Lookup::catmull_rom ? Cubic{0, 0.5}
         : l == Lookup::mitchell  ? Cubic{1.0 / 3, 1.0 / 3}
                                  : Cubic{1, 0};
}

/// Squares of side 1 / scale.
template <std::floating_point R>
struct CheckerColors {
  R scale = 8;
  std::array<R, 3> even{1, 1, 1}, odd{0, 0, 0};
};

/// Colours of `n` points from a pyramid. Only what is covered is looked up. Bilinear and nearest read level
/// 0; so do the cubics where there are no derivatives.
template <std::floating_point R>
void look_up(const TexelPyramid& p, const Filtering& filter, const UvRows<R>& in, std::size_t n,
             const RgbaRows<R>& out) {
  const int last = static_cast<int>(p.levels.size()) - 1;
  const CubicCurve<R> cubic(cubic_of(filter.kind));
  for (std::size_t x = 0; x < n; ++x) {
    if (!in.covers(x)) {
      out.put(x, {});
      continue;
    }
    if (filter.kind == Lookup::ewa) {
      out.put(x, elliptical<ColorSum<R>>(p, in, x, static_cast<R>(filter.max_anisotropy)));
      continue;
    }
    R level = 0;
    if (filter.kind > Lookup::bilinear && in.du_dx != nullptr)
      level = pyramid_level(in.du_dx[x], in.dv_dx[x], in.du_dy[x], in.dv_dy[x], p.levels[0], last);
    if (is_cubic(filter.kind)) {
      const R s = placed(in.u[x], p.wrap_u), t = R(1) - placed(in.v[x], p.wrap_v);
      out.put(x, over_levels(level, [&](int l) { return bicubic(p, p.level(l), cubic, s, t); }));
      continue;
    }
    const R s = fold(in.u[x], p.wrap_u), t = R(1) - fold(in.v[x], p.wrap_v);
    if (filter.kind == Lookup::nearest)
      out.put(x, nearest(p.levels[0], s, t));
    else
      out.put(x, over_levels(level, [&](int l) { return bilinear(p, p.level(l), s, t); }));
  }
}

/// Colours of `n` points of a checkerboard, with alpha 1. Nearest is the value at the point; the other
/// filters are the mean over the box around the pixel's footprint, of sides |du/dx| + |du/dy| and |dv/dx| +
/// |dv/dy|, without error.
template <std::floating_point R>
void look_up(const CheckerColors<R>& c, const Filtering& filter, const UvRows<R>& in, std::size_t n,
             const RgbaRows<R>& out) {
  const R half_scale = R(0.5) * c.scale;
  for (std::size_t x = 0; x < n; ++x) {
    if (!in.covers(x)) {
      out.put(x, {});
      continue;
    }
    const R u = in.u[x] * c.scale, v = in.v[x] * c.scale;
    R mean_u = 0, mean_v = 0;
    if (filter.kind == Lookup::nearest) {
      mean_u = square_wave(u), mean_v = square_wave(v);
    } else {
      mean_u = square_wave_mean(u, (std::abs(in.du_dx[x]) + std::abs(in.du_dy[x])) * half_scale);
      mean_v = square_wave_mean(v, (std::abs(in.dv_dx[x]) + std::abs(in.dv_dy[x])) * half_scale);
    }
    const R e = even_share(mean_u, mean_v), o = R(1) - e;
    out.put(x,
            {e * c.even[0] + o * c.odd[0], e * c.even[1] + o * c.odd[1], e * c.even[2] + o * c.odd[2], R(1)});
  }
}

}  // namespace frustum::kernels
