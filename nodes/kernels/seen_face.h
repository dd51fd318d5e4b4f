// The face that a visible point lies on, and how far off it rounding may have put the point.
#pragma once

#include <algorithm>
#include <glm/vec3.hpp>

#include "nodes/kernels/vector.h"

namespace frustum::kernels {

struct SeenFace {
  glm::dvec3 corner, normal;  // unit, or 0 for a face without area
  double slack;
};

// Points that were interpolated in a real type of unit roundoff u lie within 8 u of the largest coordinate of
// their face's corners: a corner has gone through a transform and a cut (4 u), interpolation adds 4 u. Twice
// that is taken.
inline SeenFace seen_face(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double u) {
  const double size = std::max({largest_component(a), largest_component(b), largest_component(c)});
  return {a, normalized_or(cross(b - a, c - a), glm::dvec3(0)), 16 * u * size};
}

// The point, put back on the plane of its face.
inline glm::dvec3 on_face(const SeenFace& f, const glm::dvec3& p) {
  return p - f.normal * dot(f.normal, p - f.corner);
}

}  // namespace frustum::kernels
