#pragma once
// Products of 4x4 matrices, each entry rounded once.

#include <glm/mat4x4.hpp>

#include "nodes/kernels/double_double.h"

namespace frustum::kernels {

// a b, every entry a sum of four products to twice the precision: within 1/2 ulp and 2^-100 sum|a||b| of the
// exact product, where a plain one is off by 4 u sum|a||b|.
inline glm::dmat4 matrix_product(const glm::dmat4& a, const glm::dmat4& b) {
  glm::dmat4 out;
  for (glm::length_t c = 0; c < 4; ++c)
    for (glm::length_t r = 0; r < 4; ++r) {
      TwoTerms<double> sum{0, 0};
      for (glm::length_t k = 0; k < 4; ++k) sum = plus(sum, two_product(a[k][r], b[c][k]));
      out[c][r] = sum.hi;
    }
  return out;
}

}  // namespace frustum::kernels
