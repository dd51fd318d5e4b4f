// Curves by coefficients: P(t) = a_0 + a_1 t + ... + a_n t^n over [0, 1] (errata E66: powers, not indices).
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/bezier.h"

namespace frustum::power {

// By how much more than its own last digit an error of one in the Bezier points of a coordinate shows in
// a_i, where the points have the size `largest`: binomial(n, i) 2^i largest / |a_i|; 0 where a_i is 0. It
// grows with the degree like 3^n.
inline double amplification(std::size_t degree, std::size_t i, double coefficient, double largest) {
  if (coefficient == 0) return 0;
  return kernels::binomials<double>(degree)[i] * std::ldexp(largest, static_cast<int>(i)) /
         std::fabs(coefficient);
}

}  // namespace frustum::power
