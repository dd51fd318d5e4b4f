// Affine combinations without negative weights (errata E2): points of the convex hull.
#pragma once

#include <cstddef>
#include <glm/common.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/combination.h"

namespace frustum::vector {

// The first negative weight; weights.size() where there is none. -0 is none.
inline std::size_t first_negative(std::span<const double> weights) {
  std::size_t i = 0;
  while (i < weights.size() && !(weights[i] < 0)) ++i;
  return i;
}

// The point that the weights make, within half an ulp of it, and within the points' box: rounding once keeps
// order. A single weight of 1 gives its point, bit for bit. Requires weights that add up to 1, and are >= 0.
inline glm::dvec3 convex_combination(std::span<const double> weights, std::span<const glm::dvec3> p) {
  glm::dvec3 low = p[0], high = p[0];
  for (std::size_t i = 0; i < p.size(); ++i) low = glm::min(low, p[i]), high = glm::max(high, p[i]);
  // Weights whose sum is 1 - ulp leave up to an ulp of the box's size to the heaviest point.
  const glm::dvec3 sum = kernels::affine_combination(weights, p, kernels::Summation::exact);
  return glm::min(glm::max(sum, low), high);
}

}  // namespace frustum::vector
