// Light that comes from everywhere alike: the constant term k_a I_a that no surface hides from.
#pragma once

#include <glm/vec3.hpp>

#include <cmath>

namespace frustum {

/// Whether a colour can be that of a light: finite and not negative, so that ambient light never darkens.
inline bool is_radiance(const glm::dvec3& c) {
  return c.r >= 0 && c.g >= 0 && c.b >= 0 && std::isfinite(c.r + c.g + c.b);
}

}  // namespace frustum
