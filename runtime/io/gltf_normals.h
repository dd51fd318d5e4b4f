// How nodes of a glTF scene move normals.
#pragma once

#include "runtime/io/gltf_scene.h"

#include <algorithm>
#include <cmath>

namespace frustum::gltf {

// Takes normals along, without a division: the cofactors are the transposed inverse times the determinant.
inline glm::dmat3 normal_matrix(const Placement& p, bool mirrored) {
  glm::dmat3 l = p.linear;
  double most = 0;
  for (glm::length_t c = 0; c < 3; ++c)
    most = std::max({most, std::abs(l[c].x), std::abs(l[c].y), std::abs(l[c].z)});
  if (most > 0) l /= most;
  const double sign = mirrored ? -1 : 1;
  const auto cross = [&](const glm::dvec3& a, const glm::dvec3& b) {
    return glm::dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x) * sign;
  };
  return {cross(l[1], l[2]), cross(l[2], l[0]), cross(l[0], l[1])};
}

}  // namespace frustum::gltf
