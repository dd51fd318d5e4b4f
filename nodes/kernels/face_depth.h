// Depth over a face as one linear function in binary64, and how far from it rasterized depths may lie: what
// the algorithms need that put faces in order instead of comparing depths at every sample.
//
// The law that makes them agree with the depth buffer at every sample. fill_triangles compares depths that are
// rounded (DepthPlane), so near an edge where two faces meet the nearer one by exact geometry need not be the
// one that it shows; exact predicates would therefore not give its picture. Here
//   - faces are put in order by their linear depths L, right but for `level` of each face, and
//   - where the rasterized depths at a sample differ by no more than `band` of the two faces, they decide, with
//     ties to the lowest (origin, face).
// A wrong order needs |L_a - L_b| <= level_a + level_b, and rasterized depths are within `rounding` of L, so a
// wrong order is always inside the band: bands never make a picture wrong, and outside of them order alone
// decides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <glm/vec2.hpp>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/screen_triangle.h"

namespace frustum::kernels {

// How far computed places of cuts may be off. Pictures are at most 2^16 px wide and faces begin at most 2^21 px
// away, so rounding moves a point by less than 2^-30 px; samples are 2^-12 px apart.
inline constexpr double place_error_px = 0x1p-26;

// z + dx (x - anchor.x) + dy (y - anchor.y), less is nearer whatever the depth convention; per px.
struct FaceDepth {
  double z = 0, dx = 0, dy = 0;
  glm::dvec2 anchor{0};
  double level = 0;  // two depths that differ by no more than their faces' levels have no order
  double band = 0;   // rounding + level; of two faces the sum

  double at(const glm::dvec2& p_px) const {
    return (z + dy * (p_px.y - anchor.y)) + dx * (p_px.x - anchor.x);
  }
  // How much a displacement by place_error_px changes the depth.
  double slope_error() const { return place_error_px * (std::fabs(dx) + std::fabs(dy)); }
};

// A face that can be drawn: its snapped corners in the mesh's order, and its depth.
struct ScreenFace {
  std::array<GridPoint, 3> corner;
  FaceDepth depth;
  bool drawn = false;  // false: a corner is NaN or out of range, or there is no area
};

inline glm::dvec2 to_px(GridPoint p) {
  return {p.x * (1.0 / corner_unit), p.y * (1.0 / corner_unit)};  // exact
}

// The face's linear depth and its tolerances. `sign` is -1 where the greatest depth is the nearest, else 1.
template <std::floating_point R>
ScreenFace screen_face(const ScreenMesh<R>& mesh, std::uint32_t face, R sign);

// All faces, by index. Parallel; the result does not depend on the number of threads.
template <std::floating_point R>
std::vector<ScreenFace> screen_faces(const ScreenMesh<R>& mesh, R sign) {
  std::vector<ScreenFace> all(mesh.face.size());
  parallel_blocks(all.size(), usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) all[f] = screen_face(mesh, static_cast<std::uint32_t>(f), sign);
  });
  return all;
}

namespace face_depth_detail {

// Bounds on |DepthPlane<R>::at - L| over the face, and what L itself may be off in order tests.
//   gradient: rounded once to R; each of five further roundings of DepthPlane::at costs u; 8 u covers them
//   clamp:    keeps the rasterized depth within the corners', so no error exceeds their range
//   fit:      binary64 may cancel in the gradients of slivers; then L misses the corners themselves
template <std::floating_point R>
void bound(FaceDepth& d, const std::array<glm::dvec2, 3>& p, const std::array<double, 3>& z) {
  constexpr double u = sizeof(R) == 4 ? 0x1p-24 : 0x1p-53;
  const auto [least, greatest] = std::minmax({z[0], z[1], z[2]});
  const double largest = std::max(std::fabs(least), std::fabs(greatest)), range = greatest - least;
  double across = 0, down = 0, fit = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    across = std::max(across, std::fabs(p[k].x - d.anchor.x));
    down = std::max(down, std::fabs(p[k].y - d.anchor.y));
    fit = std::max(fit, std::fabs(d.at(p[k]) - z[k]));
  }
  const double terms = std::fabs(d.z) + std::fabs(d.dx) * across + std::fabs(d.dy) * down;
  const double rounding = std::min(8 * u * terms, range) + fit + 0x1p-48 * terms;
  d.level = rounding + std::min(2 * d.slope_error(), range) + 0x1p-47 * largest;
  d.band = rounding + d.level;
}

}  // namespace face_depth_detail

template <std::floating_point R>
ScreenFace screen_face(const ScreenMesh<R>& mesh, std::uint32_t face, R sign) {
  ScreenFace out{};
  std::array<glm::dvec2, 3> p;
  std::array<double, 3> z;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec<4, R>& v = mesh.position[mesh.face[face][static_cast<glm::length_t>(k)]];
    const auto snapped = snap(v, mesh.corner_bits);
    if (!snapped) return out;
    out.corner[k] = *snapped;
    p[k] = to_px(*snapped);
    z[k] = static_cast<double>(sign * v.z);
  }
  const auto above = [&](std::size_t i, std::size_t j) {  // the anchor: as ScreenTriangle::make has it
    return std::pair(p[i].y, p[i].x) < std::pair(p[j].y, p[j].x);
  };
  std::array<std::size_t, 3> by{0, 1, 2};
  std::sort(by.begin(), by.end(), above);
  const std::int64_t area = twice_area(out.corner[by[0]], out.corner[by[1]], out.corner[by[2]]);
  if (area == 0) return out;
  FaceDepth& d = out.depth;
  d.anchor = p[by[0]];
  d.z = z[by[0]];
  const double dz1 = z[by[1]] - d.z, dz2 = z[by[2]] - d.z;
  const glm::dvec2 e1 = p[by[1]] - d.anchor, e2 = p[by[2]] - d.anchor;
  const double per_px =
      static_cast<double>(std::int64_t{corner_unit} * corner_unit) / static_cast<double>(area);
  d.dx = (dz1 * e2.y - dz2 * e1.y) * per_px;
  d.dy = (dz2 * e1.x - dz1 * e2.x) * per_px;
  face_depth_detail::bound<R>(d, p, z);
  out.drawn = true;
  return out;
}

}  // namespace frustum::kernels
