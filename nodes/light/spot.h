// Light from a point into a cone.
#pragma once

#include "nodes/kernels/falloff.h"
#include "nodes/kernels/vector.h"

#include <numbers>
#include <optional>
#include <string_view>

namespace frustum {

struct Spot {
  glm::dvec3 position, direction, attenuation;
  double inner, outer;  ///< radians from the axis: where the light starts to fade, and where it ends
};

struct SpotFault {
  std::string_view code, param, what;
};

/// What is wrong with the numbers of a spot; nothing where 0 <= inner <= outer, outer in (0, pi / 2], the axis has
/// a length, and the strength is positive and finite at every distance above 0 from a place that is finite.
inline std::optional<SpotFault> fault_of_spot(const Spot& s) {
  if (!kernels::is_place(s.position))
    return SpotFault{"not_finite", "position", "the position of the light is not finite"};
  if (!kernels::normalized(s.direction))
    return SpotFault{"zero_direction", "direction", "the direction of the light has no length"};
  if (!kernels::falls_off(s.attenuation))
    return SpotFault{"bad_attenuation", "attenuation",
                     "the attenuation coefficients must be finite, not negative and not all zero"};
  if (!(s.outer > 0 && s.outer <= std::numbers::pi / 2))
    return SpotFault{"bad_cone", "outer",
                     "the light ends at more than 0 and at most 90 degrees from the axis"};
  if (!(s.inner >= 0 && s.inner <= s.outer))
    return SpotFault{"bad_cone", "inner", "the light must not start to fade beyond where it ends"};
  return std::nullopt;
}

}  // namespace frustum
