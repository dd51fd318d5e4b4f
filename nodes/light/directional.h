// Light from infinitely far away.
#pragma once

#include "nodes/kernels/vector.h"

#include <optional>

namespace frustum {

/// The unit vector the light travels along; nothing where `direction` has none (zero, NaN, infinite).
inline std::optional<glm::dvec3> travel_direction(const glm::dvec3& direction) {
  return kernels::normalized(direction);
}

}  // namespace frustum
