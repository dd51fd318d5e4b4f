// How the light of a place weakens with distance: 1 / (x + y d + z d^2).
#pragma once

#include <glm/vec3.hpp>

#include <cmath>

namespace frustum::kernels {

/// Whether 1 / (a.x + a.y d + a.z d^2) is positive and finite for every distance d > 0.
inline bool falls_off(const glm::dvec3& a) {
  const double sum = a.x + a.y + a.z;
  return a.x >= 0 && a.y >= 0 && a.z >= 0 && sum > 0 && std::isfinite(sum);
}

inline bool is_place(const glm::dvec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace frustum::kernels
