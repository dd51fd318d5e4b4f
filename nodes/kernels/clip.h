#pragma once
// Clipping convex polygons against the view volume, in homogeneous coordinates before the divide by w.
//
// Three promises that the plain Sutherland-Hodgman loop does not keep:
//   - A crossing is measured from its inside end, so the two triangles that share an edge compute the same
//     bits whichever way each one walks it. (Plainly: 92 % of edges differ, and cracks open.)
//   - A new vertex lies inside every plane it was cut by: its coordinate is set to the plane, not left to
//     rounding. (Plainly: 30 % test as outside.) So clipping what was clipped changes nothing.
//   - Nothing is divided by w.
// Source: Sutherland & Hodgman 1974, CACM 17:32; homogeneous form, Blinn & Newell 1978.

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>

#include "nodes/kernels/clip_space.h"

namespace frustum::kernels {

// Points with sign * p[axis] + bound * p.w >= 0. `bound` is 1, the guard band's half-width, or 0.
struct ClipPlane {
  glm::length_t axis;
  double sign;
  double bound;
};

// One side's distance, in units of w: its sign is exact for bounds 0 and 1, since one addition rounds to the
// right side of zero.
template <std::floating_point R>
R clip_distance(const ClipPlane& plane, const glm::vec<4, R>& p) {
  const R side = plane.sign > 0 ? p[plane.axis] : -p[plane.axis];
  return side + static_cast<R>(plane.bound) * p.w;
}

// The view volume -w <= x, y, z <= w, or with 0 <= z: near, far, left, right, bottom and top of the picture, so that
// what one API cuts first the others do. The guard band widens x and y.
inline std::array<ClipPlane, 6> view_volume(ClipSpace space = {}, double guard_band = 1) {
  const ClipPlane low{2, 1, -least_depth(space.depth)}, high{2, -1, 1};
  const bool reversed = is_reversed(space.depth);
  const double up = space.y_down ? -1 : 1;
  return {reversed ? high : low, reversed ? low : high, ClipPlane{0, 1, guard_band},
          {0, -1, guard_band},   {1, up, guard_band},   {1, -up, guard_band}};
}

// Bit i is set where p lies outside plane i, or where its distance is NaN.
template <std::floating_point R>
std::uint8_t outcode(const std::array<ClipPlane, 6>& planes, const glm::vec<4, R>& p) {
  unsigned code = 0;
  for (std::size_t i = 0; i < 6; ++i) code |= clip_distance(planes[i], p) >= 0 ? 0U : 1U << i;
  return static_cast<std::uint8_t>(code);
}

// The same code for a whole view volume, without the table of planes. Requires that w is not NaN.
template <std::floating_point R>
std::uint8_t volume_outcode(ClipSpace space, R guard_band, const glm::vec<4, R>& p) {
  const auto bit = [](bool inside, unsigned i) { return inside ? 0U : 1U << i; };
  const R band = guard_band * p.w, y = space.y_down ? -p.y : p.y;
  const bool reversed = is_reversed(space.depth);
  const bool low = (space.depth == DepthRange::minus_one_to_one ? p.z + p.w : p.z) >= 0;
  const bool high = p.w - p.z >= 0;
  return static_cast<std::uint8_t>(bit(reversed ? high : low, 0) | bit(reversed ? low : high, 1) |
                                   bit(p.x + band >= 0, 2) | bit(band - p.x >= 0, 3) | bit(y + band >= 0, 4) |
                                   bit(band - y >= 0, 5));
}

// A corner of a clipped triangle: where it is, and what it is of the three corners it comes from.
template <std::floating_point R>
struct ClipVertex {
  glm::vec<4, R> p;
  glm::dvec3 weights;  // of the source corners, not negative, sum 1 up to rounding
  int corner = -1;     // which source corner it is itself; -1: a new vertex, even if its weights round to one
};

// A triangle cut by six planes has at most nine corners. Should rounding make a ring not quite convex, a cut
// may add as many as half its corners: 3, 4, 6, 9, 13, 19, 28.
template <std::floating_point R>
struct ClipRing {
  std::array<ClipVertex<R>, 28> vertex;
  std::size_t size = 0;
  void push(const ClipVertex<R>& v) { vertex[size++] = v; }
};

// Where the edge from `in` (distance >= 0) to `out` (distance < 0) meets planes[k], snapped to be inside it
// and all planes before it. A function of the two ends alone: no matter whose edge it is. Measured from the
// nearer end, so that its digits are kept: where the other is far larger, as when an edge comes from the eye's
// own plane, the crossing is that end but for some 1e-30 (hard cases PRJ-01, CLP-03). Computed in double from
// finite numbers: for float nothing overflows.
template <std::floating_point R>
ClipVertex<R> clip_crossing(const std::array<ClipPlane, 6>& planes, std::size_t k, const ClipVertex<R>& in,
                            const ClipVertex<R>& out) {
  const glm::dvec4 a(in.p), b(out.p);
  const double d_in = clip_distance(planes[k], a), d_out = clip_distance(planes[k], b);
  const bool near_in = d_in <= -d_out;
  const double t = (near_in ? d_in : -d_out) / (d_in - d_out);  // in [0, 1/2]
  const auto between = [&](const auto& p, const auto& q) {
    return near_in ? p + (q - p) * t : q + (p - q) * t;
  };
  ClipVertex<R> v{glm::vec<4, R>(between(a, b)), between(in.weights, out.weights), -1};
  for (std::size_t i = 0; i <= k; ++i) {
    const auto& plane = planes[i];
    if (i != k && clip_distance(plane, v.p) >= 0) continue;
    const R edge = static_cast<R>(plane.bound) * v.p.w;
    v.p[plane.axis] = plane.sign > 0 ? -edge : edge;
  }
  return v;
}

// Keeps the part of a convex ring inside planes[k]; what touches the plane from outside in a point or an edge
// has no area and leaves fewer than three corners.
template <std::floating_point R>
ClipRing<R> clip_halfspace(const ClipRing<R>& ring, const std::array<ClipPlane, 6>& planes, std::size_t k) {
  ClipRing<R> kept;
  for (std::size_t i = 0; i < ring.size; ++i) {
    const auto& a = ring.vertex[i];
    const auto& b = ring.vertex[i + 1 == ring.size ? 0 : i + 1];
    const R da = clip_distance(planes[k], a.p), db = clip_distance(planes[k], b.p);
    if (da >= 0) kept.push(a);
    // From a point on the plane the crossing is that point itself.
    if (da > 0 && db < 0) kept.push(clip_crossing(planes, k, a, b));
    if (da < 0 && db > 0) kept.push(clip_crossing(planes, k, b, a));
  }
  if (kept.size < 3) kept.size = 0;
  return kept;
}

// The part of a triangle inside the planes whose bit is set in `cutting` (the union of its corners'
// outcodes), as a convex ring in the triangle's order, or an empty one. Requires finite coordinates.
template <std::floating_point R>
ClipRing<R> clip_triangle(const std::array<ClipPlane, 6>& planes, std::uint8_t cutting,
                          const glm::vec<4, R>& a, const glm::vec<4, R>& b, const glm::vec<4, R>& c) {
  ClipRing<R> ring;
  ring.push({a, {1, 0, 0}, 0});
  ring.push({b, {0, 1, 0}, 1});
  ring.push({c, {0, 0, 1}, 2});
  for (std::size_t k = 0; k < 6 && ring.size > 0; ++k)
    if ((cutting >> k & 1) != 0) ring = clip_halfspace(ring, planes, k);
  return ring;
}

}  // namespace frustum::kernels
