// What a surface reflects.
#pragma once

#include <glm/vec3.hpp>

#include <algorithm>

namespace frustum {

/// The largest share of light that leaves again, over the three channels: above 1 the surface makes light.
/// Exact without a highlight (specular 0), an upper bound at the peak of the lobes, which are not normalised.
inline double largest_reflectance(const glm::dvec3& diffuse, const glm::dvec3& specular) {
  const glm::dvec3 sum = diffuse + specular;
  return std::max({sum.r, sum.g, sum.b});
}

}  // namespace frustum
