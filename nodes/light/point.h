// Light from a point, weaker with distance.
#pragma once

#include "nodes/kernels/falloff.h"

#include <optional>
#include <string_view>

namespace frustum {

struct PointFault {
  std::string_view code, param, what;
};

/// What is wrong with the numbers of a point light; nothing where its strength is positive and finite at every
/// distance above 0 from a place that is finite.
inline std::optional<PointFault> fault_of_point(const glm::dvec3& position, const glm::dvec3& attenuation) {
  if (!kernels::is_place(position))
    return PointFault{"not_finite", "position", "the position of the light is not finite"};
  if (!kernels::falls_off(attenuation))
    return PointFault{"bad_attenuation", "attenuation",
                      "the attenuation coefficients must be finite, not negative and not all zero"};
  return std::nullopt;
}

}  // namespace frustum
