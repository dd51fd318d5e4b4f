// How much light a surface sends back.
#pragma once

#include "nodes/kernels/reflectance.h"

#include <glm/vec3.hpp>

#include <algorithm>

namespace frustum {

/// The largest share of light from straight above that leaves again, over the three channels: above 1 the
/// surface makes light.
///   lobe  that of a highlight of 1 (nodes/kernels/reflectance.h); 0 without one
inline double largest_reflectance(const glm::dvec3& diffuse, const glm::dvec3& specular, double lobe) {
  const glm::dvec3 sum = diffuse + specular * lobe;
  return std::max({sum.r, sum.g, sum.b});
}

}  // namespace frustum
