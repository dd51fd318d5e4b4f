// Points plus vectors are points: (p, 1) + (v, 0) = (p + v, 1).
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace frustum::vector {

// Row by row p + scale v, each number rounded twice; a single v moves all. Requires as many v as p, or one.
inline std::vector<glm::dvec3> moved(std::span<const glm::dvec3> p, std::span<const glm::dvec3> v,
                                     double scale) {
  std::vector<glm::dvec3> out;
  out.reserve(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) out.push_back(p[i] + v[v.size() == 1 ? 0 : i] * scale);
  return out;
}

}  // namespace frustum::vector
