// Eye space to clip space, by perspective.
#pragma once

#include <cmath>
#include <string_view>

#include "nodes/kernels/camera.h"

namespace frustum::project {

// What makes a perspective volume impossible, or nothing: it needs 0 < near < far (far may be infinite), 0 <
// fov_y < pi and a positive aspect.
inline std::string_view fault_of_perspective(double fov_y, double aspect, double near_z, double far_z) {
  if (!(fov_y > 0 && fov_y < 4 * kernels::atan(1.0)))
    return "the field of view must lie between 0 and 180 degrees";
  if (!(aspect > 0) || !std::isfinite(aspect)) return "the resolution must be at least 1 x 1";
  if (!(near_z > 0) || !std::isfinite(near_z))
    return "near must be above 0: a perspective has no depth at the eye";
  if (!(far_z > near_z)) return "far must be beyond near";
  return {};
}

}  // namespace frustum::project
