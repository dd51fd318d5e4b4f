// What of a texture a pixel sees: the ellipse that a circle of radius one pixel becomes, and the level of the
// pyramid to look at.
#pragma once

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/texture_texels.h"
#include "nodes/kernels/vector.h"

#include <array>
#include <bit>

namespace frustum::kernels {

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

/// The footprint in texels of level 0, s to the right and t down: points with x^T G^-1 x <= 1, for G = J J^T
/// and J the derivatives of (s, t) by the pixel. Source: Heckbert 1989, Fundamentals of Texture Mapping and
/// Image Warping, 3.5.
template <std::floating_point R>
struct Footprint {
  R ss = 0, st = 0, tt = 0;  ///< G; not finite where the derivatives are not, or their squares
  R major = 0, minor = 0;    ///< half its axes
  R area = 0;                ///< |det J|: texels a pixel

  /// The major axis, of length `major`; along s where all directions are alike.
  std::array<R, 2> major_axis() const {
    const R along = major * major - tt, across = major * major - ss;
    const R s = along >= across ? along : st, t = along >= across ? st : across,
            length = std::sqrt(s * s + t * t);
    if (!(length > R(0))) return {major, R(0)};
    return {s / length * major, t / length * major};
  }
};

/// `minor` is |det J| / major, which keeps its digits where the ellipse is a needle (hard case TEX-11), where
/// the difference of eigenvalues has none.
template <std::floating_point R>
Footprint<R> footprint(const UvRows<R>& in, std::size_t x, R width, R height) {
  const R sx = in.du_dx[x] * width, sy = in.du_dy[x] * width, tx = -in.dv_dx[x] * height,
          ty = -in.dv_dy[x] * height;
  Footprint<R> f;
  f.ss = sx * sx + sy * sy, f.st = sx * tx + sy * ty, f.tt = tx * tx + ty * ty;
  const R half = R(0.5) * (f.ss - f.tt);
  f.major = std::sqrt(R(0.5) * (f.ss + f.tt) + std::sqrt(half * half + f.st * f.st));
  f.area = std::abs(difference_of_products(sx, ty, sy, tx));
  f.minor = f.major > R(0) ? f.area / f.major : f.major;
  return f;
}

/// The footprint with its minor axis made at least major / most, its major axis as it was: the spectral form,
/// in which (major^2 - G) / (major^2 - minor^2) is the projection onto the minor axis. Requires most >= 1.
template <std::floating_point R>
Footprint<R> widened(Footprint<R> f, R most) {
  const R least = f.major / most;
  if (!(f.minor < least)) return f;
  const R larger = f.major * f.major,
          share = (least * least - f.minor * f.minor) / (larger - f.minor * f.minor);
  f.ss += share * (larger - f.ss), f.tt += share * (larger - f.tt), f.st -= share * f.st;
  f.minor = least, f.area = f.major * least;
  return f;
}

}  // namespace frustum::kernels
