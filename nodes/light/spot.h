// Light from a point into a cone.
#pragma once

#include <cmath>

namespace frustum {

/// Whether the angles from the axis (radians) make a cone: 0 <= inner <= outer, and outer in (0, pi / 2].
inline bool is_cone(double inner, double outer) {
  constexpr double right_angle = 0x1.921fb54442d18p+0;
  return inner >= 0 && inner <= outer && outer > 0 && outer <= right_angle;
}

}  // namespace frustum
