// How much of a texture one pixel of a face sees at most, from its corners alone.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/mat2x2.hpp>
#include <glm/vec2.hpp>
#include <limits>

namespace frustum::kernels {

// A face on the screen: corners in pixels as they are rasterized (snapped), 1/w there, and its coordinates.
struct UvFace {
  std::array<glm::dvec2, 3> px;
  std::array<double, 3> per_w;
  std::array<glm::dvec2, 3> uv;
};

// An upper bound of |d(s, t)/dx| and |d(s, t)/dy| over the face, (s, t) = texels_from_uv (u, v), for
// hyperbolic as well as for affine interpolation, and for the numbers that interpolate_attributes stores in
// single precision. 0 for a face without area, which has no sample; infinite where a number is not finite or
// 1/w not positive.
//
// With U = u/w and W = 1/w linear on the screen, du/dx = (U_x - u W_x) / W. The numerator is affine in (u,
// v), so its length is greatest at a corner, and W is least at one. Affine interpolation is the same with W =
// 1. Stored slopes are off by some roundings of the products they are sums of, each at most (sum of |g_i| q_i
// / min q) |uv_i - uv_k|: 2^-20 of that is added. Where a rasterizer snaps corners more coarsely (to 2^-4 px
// at least), samples may lie 1/16 px outside: W is taken as that much smaller, and the numerator as that much
// larger. Tight where the farthest corner has the steepest numerator, as on a plane.
inline double greatest_uv_slope(const UvFace& f, const glm::dmat2& texels_from_uv) {
  const auto& p = f.px;
  const double area = (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[2].x - p[0].x) * (p[1].y - p[0].y);
  if (area == 0) return 0;
  std::array<glm::dvec2, 3> g;  // gradients of the barycentric coordinates
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 side = p[(i + 2) % 3] - p[(i + 1) % 3];
    g[i] = glm::dvec2(-side.y, side.x) / area;
  }
  const auto bound = [&](const std::array<double, 3>& q) {
    double largest = 0, products = 0, reach = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto c = static_cast<glm::length_t>(k);
      reach += std::fabs(g[0][c] * q[0] + g[1][c] * q[1] + g[2][c] * q[2]) / 16;
    }
    const double least = std::min({q[0], q[1], q[2]}) - reach;
    if (!(least > 0)) return std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      glm::dvec2 by_x(0.0), by_y(0.0);
      for (std::size_t j = 0; j < 3; ++j) {
        const glm::dvec2 d = texels_from_uv * (f.uv[j] - f.uv[k]);
        by_x += d * (g[j].x * q[j]), by_y += d * (g[j].y * q[j]);
        // The map's rounding counts by its entries, which may cancel in d.
        const glm::dvec2 raw = f.uv[j] - f.uv[k];
        double size = 0;
        for (glm::length_t c = 0; c < 2; ++c)
          size += (std::fabs(texels_from_uv[c].x) + std::fabs(texels_from_uv[c].y)) * std::fabs(raw[c]);
        products += (std::fabs(g[j].x) + std::fabs(g[j].y)) * q[j] * size;
      }
      largest = std::max({largest, std::hypot(by_x.x, by_x.y), std::hypot(by_y.x, by_y.y)});
    }
    return (largest + 2 * reach * (largest / least) + 0x1p-20 * products) / least;
  };
  if (!(std::min({f.per_w[0], f.per_w[1], f.per_w[2]}) > 0)) return std::numeric_limits<double>::infinity();
  const double hyperbolic = bound(f.per_w), affine = bound({1, 1, 1}), both = std::max(hyperbolic, affine);
  return hyperbolic + affine < std::numeric_limits<double>::infinity()
             ? both
             : std::numeric_limits<double>::infinity();
}

}  // namespace frustum::kernels
