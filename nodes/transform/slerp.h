// Rotations between two rotations, at constant speed, along the shorter way.
#pragma once

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec4.hpp>

#include "nodes/kernels/affine.h"
#include "nodes/kernels/elementary.h"
#include "nodes/kernels/vector.h"

namespace frustum::transform {

// The angle between two unit quaternions, in [0, pi], within 4 ulp also near both ends.
// Source: Kahan 2006: 2 atan2(|a - b|, |a + b|); acos(a.b) is flat there.
inline double arc(const glm::dvec4& a, const glm::dvec4& b) {
  return 2 * kernels::atan2(kernels::norm(a - b), kernels::norm(a + b));
}

// a at t = 0 and b or -b, the same rotation, at t = 1; unit to 2 u. Where the angle is small the two sines' ratio
// is t, and nothing is divided by zero. Rotations half a turn apart have two shorter ways: that by +b is taken.
// Source: Shoemake 1985, SIGGRAPH 19(3):245.
inline glm::dvec4 slerp(const glm::dvec4& a, glm::dvec4 b, double t) {
  if (kernels::dot(a, b) < 0) b = -b;
  const double angle = arc(a, b);
  double from = 1 - t, to = t;
  if (angle > 0x1p-27) {  // below, sin(t x) / sin(x) is t to less than x^2 / 6 < u
    const double whole = kernels::sin(angle);
    from = kernels::sin((1 - t) * angle) / whole, to = kernels::sin(t * angle) / whole;
  }
  return kernels::normalized_or(a * from + b * to, a);
}

}  // namespace frustum::transform
