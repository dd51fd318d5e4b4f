// Light from a rectangle.
#pragma once

#include "nodes/kernels/falloff.h"
#include "nodes/kernels/vector.h"

#include <optional>
#include <string_view>

namespace frustum {

struct AreaFault {
  std::string_view code, param, what;
};

/// What is wrong with the numbers of a rectangle; nothing where it is finite and its sides are at right angles to
/// within 2^-20 and have a length.
inline std::optional<AreaFault> fault_of_area(const glm::dvec3& position, const glm::dvec3& edge_u,
                                              const glm::dvec3& edge_v) {
  if (!kernels::is_place(position))
    return AreaFault{"not_finite", "position", "the position of the light is not finite"};
  const auto u = kernels::normalized(edge_u), v = kernels::normalized(edge_v);
  if (!u) return AreaFault{"no_area", "edge_u", "a side of the light has no length"};
  if (!v) return AreaFault{"no_area", "edge_v", "a side of the light has no length"};
  if (!(std::abs(kernels::dot(*u, *v)) <= 0x1p-20))
    return AreaFault{"no_rectangle", "edge_v", "the sides of the light are not at right angles"};
  return std::nullopt;
}

}  // namespace frustum
