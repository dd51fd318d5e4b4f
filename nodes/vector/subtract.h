// Points minus points are vectors: (p, 1) - (q, 1) = (p - q, 0).
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace frustum::vector {

// Row by row p - q, each number rounded once; a single q is taken from all. Requires as many q as p, or one.
inline std::vector<glm::dvec3> differences(std::span<const glm::dvec3> p, std::span<const glm::dvec3> q) {
  std::vector<glm::dvec3> out;
  out.reserve(p.size());
  for (std::size_t i = 0; i < p.size(); ++i) out.push_back(p[i] - q[q.size() == 1 ? 0 : i]);
  return out;
}

}  // namespace frustum::vector
