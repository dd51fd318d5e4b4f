// The mirror image of vectors: r = 2 n (n.l) - l for unit n (errata E34 and E46: right as printed).
#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/vector.h"

namespace frustum::vector {

namespace reflect_detail {
inline kernels::TwoTerms<double> dot(const glm::dvec3& a, const glm::dvec3& b) {
  return kernels::plus(kernels::plus(kernels::two_product(a.x, b.x), kernels::two_product(a.y, b.y)),
                       kernels::two_product(a.z, b.z));
}
}  // namespace reflect_detail

// r = 2 n (n.l) / (n.n) - l: l and r point away from the surface and make the same angle with n, which may have any
// length, since it is divided out and never normalised. Each component within 1 ulp of |l|, so |r| = |l| within
// 2 ulp. Nothing where n has no direction; l is of at most 2^400.
inline std::optional<glm::dvec3> mirrored(const glm::dvec3& l, const glm::dvec3& normal) {
  const double largest = kernels::largest_component(normal);
  if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
  const glm::dvec3 n = normal * kernels::power_of_two_towards_one(largest);
  const auto along = kernels::quotient(reflect_detail::dot(n, l), reflect_detail::dot(n, n));
  glm::dvec3 r;
  for (glm::length_t axis = 0; axis < 3; ++axis)
    r[axis] = kernels::plus(kernels::product(along, {2 * n[axis], 0}), {-l[axis], 0}).hi;
  return r;
}

}  // namespace frustum::vector
