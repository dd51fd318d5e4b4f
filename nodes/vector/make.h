// Rows of numbers from a grid of parameters: what points and vectors are made of.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

namespace frustum::vector {

// The rows, and after them `count` more on the way from the last row by equal steps; the k-th is last + k step,
// from its index, so that steps do not add up their rounding.
inline std::vector<glm::dvec3> rows_of(std::vector<glm::dvec3> rows, std::size_t count,
                                       const glm::dvec3& step) {
  if (rows.empty()) return rows;
  const glm::dvec3 last = rows.back();
  for (std::size_t k = 1; k <= count; ++k) rows.push_back(last + step * static_cast<double>(k));
  return rows;
}

}  // namespace frustum::vector
