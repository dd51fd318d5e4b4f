// How smoothly pieces of a curve meet (errata E64, E65).
//
// C^k: derivatives up to order k from both sides agree. (Each piece by itself is differentiable without
// end.) G^k: some regular change of parameter makes them agree, so that with the left derivatives l_i and
// the right ones r_i there are b_1 > 0, b_2 ...
//   r_1 = b_1 l_1,   r_2 = b_1^2 l_2 + b_2 l_1,   r_3 = b_1^3 l_3 + 3 b_1 b_2 l_2 + b_3 l_1
// (Faa di Bruno's formula).
// Each b_k enters order k along l_1 only: the best one is what is left of r_k along l_1, and the residual
// what is left across.
// Source: Barsky & DeRose 1989, "Geometric continuity of parametric curves", IEEE CG&A 9(6):60.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <limits>

#include "nodes/kernels/vector.h"

namespace frustum::continuity {

inline constexpr std::size_t highest_order = 3;
using Derivatives = std::array<glm::dvec3, highest_order + 1>;  // value first

struct Joint {
  int c = -1, g = -1;  // the highest order that holds, -1 for a gap; at most highest_order
  // |l_k - r_k|, and the part of r_k that no change of parameter makes of the left side. From order 1 on
  // relative to the largest derivative up to that order. Infinite where an order cannot hold: no tangent,
  // or the opposite one.
  std::array<double, highest_order + 1> c_residual{}, g_residual{};
};

// What derivatives up to order k are measured by.
inline double size_of(const Derivatives& d, std::size_t k) {
  double size = 0;
  for (std::size_t i = 1; i <= k; ++i) size = std::max(size, kernels::norm(d[i]));
  return size;
}

inline double relative(double residual, double size) { return residual == 0 ? 0 : residual / size; }

// Residuals of the geometric orders 1 to 3. A side whose first derivative is at most `still` of its largest
// has no tangent.
inline void measure_geometric(const Derivatives& l, const Derivatives& r, double still, Joint& out) {
  for (std::size_t k = 1; k <= highest_order; ++k)
    out.g_residual[k] = std::numeric_limits<double>::infinity();
  const auto unit = kernels::normalized(l[1]);
  const double speed = kernels::norm(l[1]);
  const auto moves = [&](const Derivatives& d) {
    return kernels::norm(d[1]) > still * size_of(d, highest_order);
  };
  if (!unit || !moves(l) || !moves(r)) return;
  const double b1 = kernels::dot(r[1], *unit) / speed;
  if (!(b1 > 0)) return;
  double b2 = 0;
  for (std::size_t k = 1; k <= highest_order; ++k) {
    glm::dvec3 moved(0);  // what the reparametrised left side has without its term b_k l_1
    if (k == 2) moved = l[2] * (b1 * b1);
    if (k == 3) moved = l[3] * (b1 * b1 * b1) + l[2] * (3 * b1 * b2);
    const glm::dvec3 rest = r[k] - moved;
    const double along = kernels::dot(rest, *unit);
    if (k == 2) b2 = along / speed;
    out.g_residual[k] =
        relative(kernels::norm(rest - *unit * along), std::max(size_of(r, k), kernels::norm(moved)));
  }
}

// Orders up to `orders` hold while their residual is at most `tolerance`; `gap` is what ends of pieces may
// lie apart. Derivatives are by parameters in which pieces are about 1 long.
inline Joint judge(const Derivatives& l, const Derivatives& r, std::size_t orders, double tolerance,
                   double gap) {
  Joint out;
  out.c_residual[0] = out.g_residual[0] = kernels::norm(r[0] - l[0]);
  for (std::size_t k = 1; k <= highest_order; ++k)
    out.c_residual[k] = relative(kernels::norm(r[k] - l[k]), std::max(size_of(l, k), size_of(r, k)));
  measure_geometric(l, r, tolerance, out);
  const auto highest = [&](const std::array<double, highest_order + 1>& residual) {
    int k = -1;
    for (std::size_t i = 0; i <= orders && residual[i] <= (i == 0 ? gap : tolerance); ++i)
      k = static_cast<int>(i);
    return k;
  };
  out.c = highest(out.c_residual), out.g = highest(out.g_residual);
  return out;
}

}  // namespace frustum::continuity
