// P = a_1 P_1 + ... + a_m P_m with a_1 + ... + a_m = 1: the factors that keep w = 1, so that the sum is a point.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nodes/kernels/combination.h"

namespace frustum::vector {

inline std::vector<glm::dvec3> affine_combinations(std::span<const std::vector<double>> weights,
                                                   std::span<const glm::dvec3> p, kernels::Summation how) {
  std::vector<glm::dvec3> out;
  for (const auto& row : weights) out.push_back(kernels::affine_combination(row, p, how));
  return out;
}

}  // namespace frustum::vector
