// Where a screen triangle lies, exactly: snapped corners, edge functions, the plane of its depth.
// Screen: x to the right, y down, in pixels; pixel (x, y) is the square [x, x+1) x [y, y+1).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

namespace frustum::kernels {

// Corners lie on a grid of 2^-8 px, samples on one of 2^-12 px.
inline constexpr int corner_bits = 8, sample_bits = 12;
inline constexpr int corner_unit = 1 << corner_bits, sample_unit = 1 << sample_bits;
// Corners farther out than this (px) are out of range. Edge functions then fit 64 bits: see `Edge::covers`.
inline constexpr double corner_limit_px = 1 << 21;
// Depths farther out than this are out of range. Depth planes then stay finite in binary32: two terms of at
// most 2^62 (difference of depths) * 2^30 (leg) * 2^8 (per px) / 1 (least area) * 2^22 px (distance) < 2^124.
inline constexpr double depth_limit = 0x1p60;
// The id of a sample that nothing covers.
inline constexpr std::uint32_t no_face = 0xFFFFFFFFu;

// The mesh as the rasterizer sees it. Nothing is owned.
//   position     per vertex (x_px, y_px, depth, 1/w)
//   face         per triangle its three vertices, each < position.size()
//   origin       per triangle the source triangle it stems from; empty = its own index
//   corner_bits  corners snap to 2^-corner_bits px, 4 to 8
template <std::floating_point R>
struct ScreenMesh {
  std::span<const glm::vec<4, R>> position;
  std::span<const glm::uvec3> face;
  std::span<const std::uint32_t> origin;
  int corner_bits = kernels::corner_bits;
};

// A corner on the grid of 2^-8 px, whatever the number of bits it was snapped to; |x|, |y| <= 2^29.
struct GridPoint {
  std::int32_t x, y;
};

// Snaps to the nearest point of the grid of 2^-bits px; halves go to the even one.
//   Requires |px| <= corner_limit_px. Exact: the product with a power of two rounds nothing, and adding 1.5 *
//   2^52 leaves the rounded integer in the low bits of the significand on every IEEE target.
inline std::int32_t snap(double px, int bits) {
  constexpr double shifter = 0x1.8p52;
  const double grid = px * static_cast<double>(1 << bits) + shifter;
  const auto low = static_cast<std::uint32_t>(std::bit_cast<std::uint64_t>(grid));
  return static_cast<std::int32_t>(low << (corner_bits - bits));
}

// The snapped corner, or nothing where a coordinate is NaN, infinite or out of range.
template <std::floating_point R>
std::optional<GridPoint> snap(const glm::vec<4, R>& p, int bits) {
  const bool in_range = std::abs(p.x) <= R(corner_limit_px) && std::abs(p.y) <= R(corner_limit_px) &&
                        std::abs(p.z) <= R(depth_limit) && std::isfinite(p.w);
  if (!in_range) return std::nullopt;
  return GridPoint{snap(static_cast<double>(p.x), bits), snap(static_cast<double>(p.y), bits)};
}

// Twice the signed area in units of 2^-16 px^2; positive when a, b, c turn from +x to +y. |result| <= 2^61.
inline std::int64_t twice_area(GridPoint a, GridPoint b, GridPoint c) {
  const std::int64_t bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y;
  return bx * cy - cx * by;
}

// One side of a triangle as its edge function a*x + b*y + c, positive inside.
struct Edge {
  std::int32_t a, b;  // per 2^-8 px; |a|, |b| <= 2^30
  GridPoint start;
  // 0 on a top or left edge, else -1: a sample on an edge belongs to the triangle below it or to its right.
  std::int32_t bias;

  Edge() = default;
  Edge(GridPoint from, GridPoint to)
      : a(from.y - to.y), b(to.x - from.x), start(from), bias(a > 0 || (a == 0 && b > 0) ? 0 : -1) {}

  // The edge function at the corner of pixel (x, y), in units of 2^-16 px^2.
  // |x|, |y| <= 2^16 px and |start| <= 2^29 keep each factor below 2^30, so |result| < 2^61.
  std::int64_t at_pixel(std::int64_t x, std::int64_t y) const {
    return a * (x * corner_unit - start.x) + b * (y * corner_unit - start.y);
  }

  // What a sample (x, y) * 2^-12 px into its pixel adds, rounded down so that the sign test stays exact:
  // 16 e + t >= 0 with t = a x + b y + bias is e + floor(t / 16) >= 0 for integers. |result| <= 2^39.
  std::int64_t at_offset(std::int64_t x, std::int64_t y) const {
    return (a * x + b * y + bias) >> (sample_bits - corner_bits);
  }

  // Whether the sample at `offset` in the pixel where the edge function is `e` is inside or on its top-left
  // rim.
  static bool covers(std::int64_t e, std::int64_t offset) { return e + offset >= 0; }
};

// Depth at a sample: z + dx * (sample.x - anchor.x) + dy * (sample.y - anchor.y), held within the corners'
// depths. The anchor is the triangle's upper (then left) corner, so neither the order of the corners nor the
// tile matters. Error: the gradient is rounded once from binary64, so |error| <= 4u (|z| + (|dx| + |dy|) *
// extent_px) before the clamp; for extents below 2^13 px that is less than what moving a corner by half a
// grid step does.
template <std::floating_point R>
struct DepthPlane {
  R z, dx, dy;        // per px
  R least, greatest;  // of the corners
  GridPoint anchor;

  // Signed distance in px from the anchor along one axis: a whole number plus a fraction, each exact.
  static R whole_px(std::int32_t pixel, std::int32_t anchor) {
    return static_cast<R>(pixel - (anchor >> corner_bits));
  }
  static R fraction_px(std::int32_t offset, std::int32_t anchor) {
    const int grid_per_corner = sample_unit / corner_unit;
    return static_cast<R>(offset - (anchor & (corner_unit - 1)) * grid_per_corner) * R(1.0 / sample_unit);
  }
  R clamp(R depth) const {
    depth = depth < least ? least : depth;
    return depth > greatest ? greatest : depth;
  }
  R at(std::int32_t x, std::int32_t y, std::int32_t offset_x, std::int32_t offset_y) const {
    const R across = whole_px(x, anchor.x) + fraction_px(offset_x, anchor.x);
    const R down = whole_px(y, anchor.y) + fraction_px(offset_y, anchor.y);
    return clamp((z + dy * down) + dx * across);
  }
};

// Everything that coverage and depth need of one triangle. The six orders of its corners give the same bits.
template <std::floating_point R>
struct ScreenTriangle {
  std::array<Edge, 3> edge;
  DepthPlane<R> depth;

  // Nothing where the snapped area is zero. `sign` is -1 where the greatest depth is the nearest, else 1.
  //   Requires corners that `snap` accepted.
  static std::optional<ScreenTriangle> make(const std::array<GridPoint, 3>& corner, std::array<R, 3> z,
                                            R sign);
};

// Nothing where the triangle has a corner that is NaN or out of range, or no area.
template <std::floating_point R>
std::optional<ScreenTriangle<R>> screen_triangle(const ScreenMesh<R>& mesh, std::uint32_t face, R sign) {
  std::array<GridPoint, 3> corner;
  std::array<R, 3> z;
  for (int k = 0; k < 3; ++k) {
    const glm::vec<4, R>& p = mesh.position[mesh.face[face][k]];
    const auto snapped = snap(p, mesh.corner_bits);
    if (!snapped) return std::nullopt;
    corner[static_cast<std::size_t>(k)] = *snapped;
    z[static_cast<std::size_t>(k)] = p.z;
  }
  return ScreenTriangle<R>::make(corner, z, sign);
}

template <std::floating_point R>
std::optional<ScreenTriangle<R>> ScreenTriangle<R>::make(const std::array<GridPoint, 3>& corner,
                                                         std::array<R, 3> z, R sign) {
  auto [p0, p1, p2] = corner;
  auto [z0, z1, z2] = z;
  const auto sort = [](GridPoint& p, R& zp, GridPoint& q, R& zq) {
    if (std::pair(q.y, q.x) < std::pair(p.y, p.x)) {
      std::swap(p, q);
      std::swap(zp, zq);
    }
  };
  sort(p0, z0, p1, z1);
  sort(p1, z1, p2, z2);
  sort(p0, z0, p1, z1);

  const std::int64_t area = twice_area(p0, p1, p2);
  if (area == 0) return std::nullopt;
  ScreenTriangle t;
  if (area > 0)
    t.edge = {Edge(p0, p1), Edge(p1, p2), Edge(p2, p0)};
  else
    t.edge = {Edge(p0, p2), Edge(p2, p1), Edge(p1, p0)};

  z0 *= sign, z1 *= sign, z2 *= sign;
  const double dz1 = static_cast<double>(z1) - static_cast<double>(z0);
  const double dz2 = static_cast<double>(z2) - static_cast<double>(z0);
  const double per_px = corner_unit / static_cast<double>(area);
  t.depth.dx = static_cast<R>((dz1 * (p2.y - p0.y) - dz2 * (p1.y - p0.y)) * per_px);
  t.depth.dy = static_cast<R>((dz2 * (p1.x - p0.x) - dz1 * (p2.x - p0.x)) * per_px);
  t.depth.z = z0;
  t.depth.least = std::min({z0, z1, z2});
  t.depth.greatest = std::max({z0, z1, z2});
  t.depth.anchor = p0;
  return t;
}

}  // namespace frustum::kernels
