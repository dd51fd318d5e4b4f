// A coordinate system of three vectors and an origin: p = O + p1 a + p2 b + p3 c (errata E5).
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/matrix.h"
#include "nodes/kernels/vector.h"

namespace frustum::vector {

struct Frame {
  glm::dmat3 axes, inverse;  // columns a, b, c
  glm::dvec3 origin;
  double rcond;  // of the axes brought to length 1: 1 is at right angles, 0 is a plane

  // From coordinates in the frame to the world, and back. Vectors do not know the origin.
  glm::dvec3 world_vector(const glm::dvec3& v) const { return axes * v; }
  glm::dvec3 world_point(const glm::dvec3& p) const { return origin + axes * p; }
  glm::dvec3 frame_vector(const glm::dvec3& v) const { return inverse * v; }
  // The way from the origin is taken first, with what its rounding leaves: a far origin costs no digits.
  glm::dvec3 frame_point(const glm::dvec3& p) const {
    glm::dvec3 hi, lo;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      const auto away = kernels::two_sum(p[axis], -origin[axis]);
      hi[axis] = away.hi, lo[axis] = away.lo;
    }
    return inverse * hi + inverse * lo;
  }
  glm::dmat4 world_from_frame() const {
    glm::dmat4 m(1.0);
    for (glm::length_t c = 0; c < 3; ++c) m[c] = glm::dvec4(axes[c], 0);
    m[3] = glm::dvec4(origin, 1);
    return m;
  }
  glm::dmat4 frame_from_world() const {
    glm::dmat4 m(1.0);
    for (glm::length_t c = 0; c < 3; ++c) m[c] = glm::dvec4(inverse[c], 0);
    m[3] = glm::dvec4(-(inverse * origin), 1);
    return m;
  }
};

// Nothing where the axes lie in a plane, which is decided exactly. rcond = 3 / (|A| |A^-1|) of the unit axes in the
// Frobenius norm, which no rotation changes. Coordinates that go to the frame and back are off by some 8 u / rcond.
inline std::optional<Frame> frame_of(const glm::dvec3& origin, const glm::dvec3& a, const glm::dvec3& b,
                                     const glm::dvec3& c) {
  const glm::dmat3 axes(a, b, c);
  const auto back = kernels::inverse<3>(axes);
  if (!back) return std::nullopt;
  const glm::dmat3 rows = glm::transpose(back->matrix);
  glm::dvec3 stretch;
  for (glm::length_t i = 0; i < 3; ++i) stretch[i] = kernels::norm(axes[i]) * kernels::norm(rows[i]);
  return Frame{axes, back->matrix, origin, std::sqrt(3.0) / kernels::norm(stretch)};
}

}  // namespace frustum::vector
