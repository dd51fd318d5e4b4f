// A place on a surface, as a ray sees it that is sent on from there.
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "nodes/kernels/vector.h"

namespace frustum::kernels {

struct SurfacePoint {
  glm::dvec3 p{0}, p_dx{0}, p_dy{0};  // on its face, and its change per pixel
  glm::dvec3 n{0}, n_dx{0}, n_dy{0};  // the shading normal, of any length; 0: the face's own
  glm::dvec3 face_normal{0};          // unit, outside; 0 for a face without area
  double slack = 0;                   // how far off the face p may be once it is stored
};

struct UnitNormal {
  glm::dvec3 n, dx, dy;
};

// The normal that rays are bent about: the shading normal, or the face's own where there is none. n / |n| changes by
// (dn - (n/|n| . dn) n/|n|) / |n|.
inline std::optional<UnitNormal> unit_normal(const SurfacePoint& at) {
  const auto n = normalized(at.n);
  if (!n) {
    if (at.face_normal == glm::dvec3(0)) return std::nullopt;
    return UnitNormal{at.face_normal, glm::dvec3(0), glm::dvec3(0)};
  }
  const double length = norm(at.n);
  const auto change = [&](const glm::dvec3& d) { return (d - dot(*n, d) * *n) / length; };
  return UnitNormal{*n, change(at.n_dx), change(at.n_dy)};
}

}  // namespace frustum::kernels
