// Cubics by ends and derivatives, and Bezier points from them and back: r0 = 3 (p1 - p0), r3 = 3 (p3 - p2)
// (errata E66 to E68).
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/bezier.h"

namespace frustum::hermite {

// Control points of the chain through `p` with the derivatives `r`, each piece over an interval of length
// `step`. Inner points are within 2 u (|P| + step |r|); ends are those given, bit for bit. Requires two
// points or more.
template <class V, class S>
std::vector<V> bezier_points(std::span<const V> p, std::span<const V> r, const S& step) {
  std::vector<V> out{p[0]};
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    out.push_back(kernels::after_start(p[i], r[i], step));
    out.push_back(kernels::before_end(p[i + 1], r[i + 1], step));
    out.push_back(p[i + 1]);
  }
  return out;
}

// p(u) = G M (1, u, u^2, u^3) with G = [p0 p3 r0 r3]: the course's matrix, which is right.
template <class V, class S>
V by_matrix(const V& p0, const V& p3, const V& r0, const V& r3, const S& u) {
  const S u2 = u * u, u3 = u2 * u;
  const S h00 = S(1) - S(3) * u2 + S(2) * u3, h01 = S(3) * u2 - S(2) * u3;
  const S h10 = u - S(2) * u2 + u3, h11 = u3 - u2;
  return p0 * h00 + p3 * h01 + r0 * h10 + r3 * h11;
}

// The derivative at the start, or the end, of a cubic over an interval of length `step`.
template <class V, class S>
V derivative(const V& from, const V& to, const S& step) {
  const V along = to - from;
  return along * S(3) / step;
}

}  // namespace frustum::hermite
