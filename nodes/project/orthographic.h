// Eye space to clip space, by parallel projection.
#pragma once

#include <cmath>
#include <string_view>

#include "nodes/kernels/camera.h"

namespace frustum::project {

// What makes a parallel volume impossible, or nothing: it needs a positive height and aspect and finite near
// < far.
inline std::string_view fault_of_orthographic(double height, double aspect, double near_z, double far_z) {
  if (!(height > 0) || !std::isfinite(height)) return "the height of the view volume must be above 0";
  if (!(aspect > 0) || !std::isfinite(aspect)) return "the resolution must be at least 1 x 1";
  if (!std::isfinite(near_z) || !std::isfinite(far_z))
    return "near and far must be finite: a parallel volume has two ends";
  if (!(far_z > near_z)) return "far must be beyond near";
  return {};
}

}  // namespace frustum::project
