#pragma once
// Rotations as quaternions (w, x, y, z).

#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// The unit quaternion (w, x, y, z) of a rotation matrix, w >= 0: from the largest of its four, so that none is the
// small difference of large numbers. Each within 4 u. Source: Shepperd 1978, J. Guidance and Control 1:223.
inline glm::dvec4 quaternion_of(const glm::dmat3& r) {
  const double xx = r[0][0], yy = r[1][1], zz = r[2][2];
  glm::dvec4 q(1 + xx + yy + zz, r[1][2] - r[2][1], r[2][0] - r[0][2], r[0][1] - r[1][0]);
  if (xx >= yy && xx >= zz && xx > xx + yy + zz)
    q = {r[1][2] - r[2][1], 1 + xx - yy - zz, r[0][1] + r[1][0], r[0][2] + r[2][0]};
  else if (yy >= xx && yy >= zz && yy > xx + yy + zz)
    q = {r[2][0] - r[0][2], r[0][1] + r[1][0], 1 - xx + yy - zz, r[1][2] + r[2][1]};
  else if (zz > xx + yy + zz)
    q = {r[0][1] - r[1][0], r[0][2] + r[2][0], r[1][2] + r[2][1], 1 - xx - yy + zz};
  q = normalized_or(q, glm::dvec4(1, 0, 0, 0));
  return q.x < 0 ? -q : q;
}

}  // namespace frustum::kernels
