// Colours of a row of (u, v): from a pyramid of images, or from a checkerboard. The truth for every Real;
// simd/ has the twin for float, operation by operation.
//
// Rows are arrays of n numbers, one a pixel, that do not overlap; outputs may be null where nobody reads
// them.
#pragma once

#include "nodes/kernels/checkerboard.h"
#include "nodes/kernels/elementary.h"

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace frustum::kernels {

inline constexpr std::uint32_t no_point = 0xFFFFFFFFu;  ///< the id where nothing is seen

/// Texture coordinates and their change per pixel. Only trilinear lookup and the filtered checkerboard read
/// derivatives.
template <std::floating_point R>
struct UvRows {
  const R *u = nullptr, *v = nullptr;
  const R *du_dx = nullptr, *dv_dx = nullptr, *du_dy = nullptr, *dv_dy = nullptr;
  const std::uint32_t* id = nullptr;  ///< no_point gives transparent black; null: all are covered
  bool covers(std::size_t x) const { return id == nullptr || id[x] != no_point; }
};

template <std::floating_point R>
struct RgbaRows {
  std::array<R*, 4> plane{};
  void put(std::size_t x, const std::array<R, 4>& c) const {
    for (std::size_t k = 0; k < 4; ++k)
      if (plane[k] != nullptr) plane[k][x] = c[k];
  }
};

enum class EdgeRule : std::uint8_t { repeat, clamp, mirror };
enum class Lookup : std::uint8_t { nearest, bilinear, trilinear };
constexpr auto choices(Lookup) {
  return std::array{std::pair{Lookup::nearest, "nearest"}, std::pair{Lookup::bilinear, "bilinear"},
                    std::pair{Lookup::trilinear, "trilinear"}};
}

struct TexelLevel {
  int width = 0, height = 0;
  const float* rgba = nullptr;  ///< height x width x 4, row 0 is v = 1
};

struct TexelPyramid {
  std::span<const TexelLevel> levels;  ///< at least one, at most 32
  EdgeRule wrap_u = EdgeRule::repeat, wrap_v = EdgeRule::repeat;
};

/// Squares of side 1 / scale.
template <std::floating_point R>
struct CheckerColors {
  R scale = 8;
  std::array<R, 3> even{1, 1, 1}, odd{0, 0, 0};
};

/// A texture coordinate folded into [0, 1]; 0 for NaN and infinity (where clamping does not give an end).
template <std::floating_point R>
R fold(R u, EdgeRule rule) {
  R t = u;
  if (rule == EdgeRule::clamp) {
    t = t < R(1) ? t : R(1);
    return u > R(0) ? t : R(0);
  }
  if (rule == EdgeRule::repeat) {
    t = u - std::floor(u);
  } else {
    const R m = u - R(2) * std::floor(u * R(0.5));
    t = m <= R(1) ? m : R(2) - m;
  }
  return t >= R(0) ? t : R(0);
}

/// The two texels around a coordinate in [0, 1], and how far it is from the first to the second, in [0, 1].
template <std::floating_point R>
struct TexelPair {
  int first, second;
  R fraction;
};

template <std::floating_point R>
TexelPair<R> texel_pair(R t, int size, EdgeRule rule) {
  const R x = t * static_cast<R>(size) - R(0.5);
  const R low = std::floor(x);
  const int i = static_cast<int>(low), last = size - 1;
  const bool repeat = rule == EdgeRule::repeat;
  const int first = i < 0 ? (repeat ? last : 0) : i;
  const int second = i + 1 > last ? (repeat ? 0 : last) : i + 1;
  return {first, second, x - low};
}

/// log2(1 + t) = t (1 + (1 - t) q(t)) on [0, 1], exact at both ends so that levels are continuous; q
/// interpolates at the five Chebyshev nodes, and the absolute error stays below 7.3e-6.
inline constexpr std::array<float, 5> level_log2{0x1.c5471cp-2F, -0x1.1b350ap-2F, 0x1.7909dap-3F,
                                                 -0x1.8e2382p-4F, 0x1.a4ecf8p-6F};

/// log2(x) for x >= 0; at most -126 for denormals and zero, at least 128 for infinity and NaN.
template <std::floating_point R>
R log2_of_footprint(R x) {
  if constexpr (sizeof(R) == 8) {
    return x == x ? (x > 0 ? kernels::log2(x) : R(-1075)) : R(1024);
  } else {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    const auto exponent = static_cast<std::int32_t>((bits >> 23) & 0xFFu) - 127;
    const float t = std::bit_cast<float>((bits & 0x7FFFFFu) | 0x3F800000u) - 1.0F;
    float q = level_log2[4];
    for (std::size_t i = 4; i-- > 0;) q = q * t + level_log2[i];
    return static_cast<float>(exponent) + t * (1.0F + (1.0F - t) * q);
  }
}

/// The level of the pyramid at which a pixel is about one texel: log2 of the longer axis of its footprint in
/// texels of level 0, in [0, last]. NaN and infinite footprints take the last level. Source: Williams 1983;
/// the axes are the derivatives themselves (OpenGL 4.6, 8.14.1).
template <std::floating_point R>
R pyramid_level(R du_dx, R dv_dx, R du_dy, R dv_dy, const TexelLevel& base, int last) {
  const R w = static_cast<R>(base.width), h = static_cast<R>(base.height);
  const R ux = du_dx * w, vx = dv_dx * h, uy = du_dy * w, vy = dv_dy * h;
  const R a = ux * ux + vx * vx, b = uy * uy + vy * vy;
  const R larger = a != a ? a : (a > b ? a : b);
  const R level = R(0.5) * log2_of_footprint(larger);
  const R top = static_cast<R>(last);
  return level > R(0) ? (level < top ? level : top) : R(0);
}

template <std::floating_point R>
using Rgba = std::array<R, 4>;

/// a + f (b - a), held between the two: exactly a where f is 0 or b equals a, exactly b where f is 1. Plainly,
/// 1e8 and 1 give 0 at f = 1 (hard case TEX-06). NaN where either is NaN.
template <std::floating_point R>
Rgba<R> between(const Rgba<R>& a, const Rgba<R>& b, R f) {
  Rgba<R> c;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool rises = a[k] < b[k];
    const R least = rises ? a[k] : b[k], greatest = rises ? b[k] : a[k];
    R v = a[k] + f * (b[k] - a[k]);
    v = v < least ? least : v;
    v = greatest < v ? greatest : v;
    c[k] = f < R(1) ? v : b[k];
  }
  return c;
}

template <std::floating_point R>
Rgba<R> texel(const TexelLevel& level, int x, int y) {
  const float* t =
      level.rgba +
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x)) * 4;
  return {t[0], t[1], t[2], t[3]};
}

/// The four texels around (s, t) in [0, 1]^2, s to the right and t down, blended by area.
template <std::floating_point R>
Rgba<R> bilinear(const TexelPyramid& p, const TexelLevel& level, R s, R t) {
  const auto x = texel_pair(s, level.width, p.wrap_u), y = texel_pair(t, level.height, p.wrap_v);
  const auto top = between(texel<R>(level, x.first, y.first), texel<R>(level, x.second, y.first), x.fraction);
  const auto bottom =
      between(texel<R>(level, x.first, y.second), texel<R>(level, x.second, y.second), x.fraction);
  return between(top, bottom, y.fraction);
}

template <std::floating_point R>
Rgba<R> nearest(const TexelLevel& level, R s, R t) {
  const int x = static_cast<int>(s * static_cast<R>(level.width));
  const int y = static_cast<int>(t * static_cast<R>(level.height));
  return texel<R>(level, x < level.width ? x : level.width - 1, y < level.height ? y : level.height - 1);
}

/// Colours of `n` points from a pyramid. Only what is covered is looked up. Bilinear and nearest read level
/// 0.
template <std::floating_point R>
void look_up(const TexelPyramid& p, Lookup filter, const UvRows<R>& in, std::size_t n,
             const RgbaRows<R>& out) {
  const int last = static_cast<int>(p.levels.size()) - 1;
  for (std::size_t x = 0; x < n; ++x) {
    if (!in.covers(x)) {
      out.put(x, {});
      continue;
    }
    const R s = fold(in.u[x], p.wrap_u), t = R(1) - fold(in.v[x], p.wrap_v);
    if (filter == Lookup::nearest) {
      out.put(x, nearest(p.levels[0], s, t));
      continue;
    }
    R level = 0;
    if (filter == Lookup::trilinear)
      level = pyramid_level(in.du_dx[x], in.dv_dx[x], in.du_dy[x], in.dv_dy[x], p.levels[0], last);
    const int fine = static_cast<int>(level);
    const R fraction = level - static_cast<R>(fine);
    auto c = bilinear(p, p.levels[static_cast<std::size_t>(fine)], s, t);
    if (fraction > R(0))
      c = between(c, bilinear(p, p.levels[static_cast<std::size_t>(fine) + 1], s, t), fraction);
    out.put(x, c);
  }
}

/// Colours of `n` points of a checkerboard, with alpha 1. Nearest is the value at the point; the other
/// filters are the mean over the box around the pixel's footprint, of sides |du/dx| + |du/dy| and |dv/dx| +
/// |dv/dy|, without error.
template <std::floating_point R>
void look_up(const CheckerColors<R>& c, Lookup filter, const UvRows<R>& in, std::size_t n,
             const RgbaRows<R>& out) {
  const R half_scale = R(0.5) * c.scale;
  for (std::size_t x = 0; x < n; ++x) {
    if (!in.covers(x)) {
      out.put(x, {});
      continue;
    }
    const R u = in.u[x] * c.scale, v = in.v[x] * c.scale;
    R mean_u = 0, mean_v = 0;
    if (filter == Lookup::nearest) {
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
