// Texels of a pyramid by place and by number, and the simplest colours between them.
//
// Rows are arrays of n numbers, one a pixel, that do not overlap; outputs may be null where nobody reads
// them.
#pragma once

#include "nodes/kernels/half.h"

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>

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

/// border: transparent black beyond the picture.
enum class EdgeRule : std::uint8_t { repeat, clamp, mirror, border };

/// height x width x 4 numbers, row 0 is v = 1: as they are, or as binary16.
struct TexelLevel {
  int width = 0, height = 0;
  const float* rgba = nullptr;
  const std::uint16_t* half_rgba = nullptr;  ///< where rgba is null
};

struct TexelPyramid {
  std::span<const TexelLevel> levels;  ///< at least one, at most 32
  EdgeRule wrap_u = EdgeRule::repeat, wrap_v = EdgeRule::repeat;
  const TexelLevel& level(int l) const { return levels[static_cast<std::size_t>(l)]; }
  bool has_border() const { return wrap_u == EdgeRule::border || wrap_v == EdgeRule::border; }
};

/// A coordinate held within three pictures of the first one, which no filter reaches beyond at a level of one
/// texel; 0 for NaN.
template <std::floating_point R>
R held(R u) {
  return u > R(-3) ? (u < R(4) ? u : R(4)) : (u <= R(-3) ? R(-3) : R(0));
}

/// A texture coordinate folded into [0, 1]; 0 for NaN and infinity (where clamping does not give an end).
/// With a border it is held, and stays outside of [0, 1] where it is.
template <std::floating_point R>
R fold(R u, EdgeRule rule) {
  R t = u;
  if (rule == EdgeRule::border) return held(u);
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

/// The two texels around a folded coordinate, -1 for those in the border, and how far it is from the first to
/// the second, in [0, 1].
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
  if (rule == EdgeRule::border) {
    const auto of = [&](int k) { return k < 0 || k > last ? -1 : k; };
    return {of(i), of(i + 1), x - low};
  }
  const bool repeat = rule == EdgeRule::repeat;
  const int first = i < 0 ? (repeat ? last : 0) : i;
  const int second = i + 1 > last ? (repeat ? 0 : last) : i + 1;
  return {first, second, x - low};
}

template <std::floating_point R>
using Rgba = std::array<R, 4>;

/// From the nearer of the two ends: a + f (b - a) for f up to 1/2, else b + (1 - f) (a - b). At most half of a
/// difference is added, which no rounding takes beyond the other end: the result lies between a and b, is
/// exactly a where f is 0 or b equals a, and exactly b where f is 1. From one end alone, 1e8 and 1 give 0 at
/// f = 1 (hard case TEX-06). NaN where either is NaN; infinite where a - b overflows.
template <std::floating_point R>
Rgba<R> between(const Rgba<R>& a, const Rgba<R>& b, R f) {
  const bool from_b = f > R(0.5);
  const Rgba<R>&from = from_b ? b : a, &to = from_b ? a : b;
  const R share = from_b ? R(1) - f : f;
  Rgba<R> c;
  for (std::size_t k = 0; k < 4; ++k) c[k] = from[k] + share * (to[k] - from[k]);
  return c;
}

/// The colours of level `level` and of the one after it, blended by its fraction.
template <std::floating_point R, class At>
Rgba<R> over_levels(R level, const At& at) {
  const int fine = static_cast<int>(level);
  const R fraction = level - static_cast<R>(fine);
  const Rgba<R> c = at(fine);
  return fraction > R(0) ? between(c, at(fine + 1), fraction) : c;
}

/// The four numbers of the texel in column x of row y, both within the level: where they lie, or in `copy`.
inline const float* texel_numbers(const TexelLevel& level, int x, int y, std::array<float, 4>& copy) {
  const std::size_t at =
      (static_cast<std::size_t>(y) * static_cast<std::size_t>(level.width) + static_cast<std::size_t>(x)) * 4;
  if (level.rgba != nullptr) return level.rgba + at;
  for (std::size_t k = 0; k < 4; ++k) copy[k] = from_half(level.half_rgba[at + k]);
  return copy.data();
}

/// The texel in column x of row y; transparent black where one of them is -1.
template <std::floating_point R>
Rgba<R> texel(const TexelLevel& level, int x, int y) {
  if ((x | y) < 0) return {};
  std::array<float, 4> copy;
  const float* t = texel_numbers(level, x, y, copy);
  return {t[0], t[1], t[2], t[3]};
}

/// Any number of a texel, as the rule sees it: in [0, size), or -1 in the border.
inline int wrapped(int i, int size, EdgeRule rule) {
  if (i >= 0 && i < size) return i;
  if (rule == EdgeRule::border) return -1;
  if (rule == EdgeRule::clamp) return i < 0 ? 0 : size - 1;
  const int period = rule == EdgeRule::mirror ? 2 * size : size, r = i % period, m = r < 0 ? r + period : r;
  return m < size ? m : period - 1 - m;
}

/// A place for filters that read many texels by `wrapped` numbers: within one period, mirrored ones not yet
/// mirrored, so that directions stay what they are. In [-3, 4].
template <std::floating_point R>
R placed(R u, EdgeRule rule) {
  if (rule == EdgeRule::repeat) return fold(u, rule);
  if (rule != EdgeRule::mirror) return held(u);
  const R m = u - R(2) * std::floor(u * R(0.5));
  return m >= R(0) ? m : R(0);
}

/// The four texels around a folded (s, t), s to the right and t down, blended by area.
template <std::floating_point R>
Rgba<R> bilinear(const TexelPyramid& p, const TexelLevel& level, R s, R t) {
  const auto x = texel_pair(s, level.width, p.wrap_u), y = texel_pair(t, level.height, p.wrap_v);
  const auto down = [&](int column) {
    return between(texel<R>(level, column, y.first), texel<R>(level, column, y.second), y.fraction);
  };
  return between(down(x.first), down(x.second), x.fraction);
}

template <std::floating_point R>
Rgba<R> nearest(const TexelLevel& level, R s, R t) {
  if (!(s >= R(0) && s <= R(1) && t >= R(0) && t <= R(1))) return {};
  const int x = static_cast<int>(s * static_cast<R>(level.width));
  const int y = static_cast<int>(t * static_cast<R>(level.height));
  return texel<R>(level, x < level.width ? x : level.width - 1, y < level.height ? y : level.height - 1);
}

}  // namespace frustum::kernels
