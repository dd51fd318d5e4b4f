// w = a_1 v_1 + ... + a_m v_m (errata E1), one result for each row of weights.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nodes/kernels/combination.h"
#include "nodes/kernels/vector.h"

namespace frustum::vector {

// The combination of the vectors for every row of weights. Requires rows as long as there are vectors.
inline std::vector<glm::dvec3> combinations(std::span<const std::vector<double>> weights,
                                            std::span<const glm::dvec3> v, kernels::Summation how) {
  std::vector<glm::dvec3> out;
  for (const auto& row : weights) out.push_back(kernels::linear_combination(row, v, how));
  return out;
}

// The first row that is not as long as there are vectors; weights.size() where all are.
inline std::size_t first_of_other_length(std::span<const std::vector<double>> weights, std::size_t vectors) {
  std::size_t i = 0;
  while (i < weights.size() && weights[i].size() == vectors) ++i;
  return i;
}

}  // namespace frustum::vector
