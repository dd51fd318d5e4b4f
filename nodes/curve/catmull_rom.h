// Curves through points whose tangents come from their neighbours.
//
// At uniform knots the tangent of point i is s (p_i+1 - p_i-1), s = 1/2 being Catmull and Rom's (errata
// E69). At knots a distance h apart it is 2 s times that of the parabola through the three points, which
// for s = 1/2 is the pyramid of Barry and Goldman:
//   2 s (d_i-1 - (p_i+1 - p_i-1) / (h_i-1 + h_i) + d_i),   d_i = (p_i+1 - p_i) / h_i.
// Source: Catmull & Rom 1974; Barry & Goldman 1988, SIGGRAPH 22(4):199; Yuksel, Schaefer & Keyser 2011, CAD
// 43:747.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/bezier.h"

namespace frustum::catmull_rom {

// 2 s times the slope in the middle of the parabola through p, q, r at knots a distance h and k apart.
template <class V, class S>
V tangent(const V& p, const V& q, const V& r, const S& h, const S& k, const S& s) {
  if (h == k) {
    const V chord = r - p;
    return chord * s / h;
  }
  const V before = (q - p) / h, after = (r - q) / k;
  const S whole = h + k;
  const V slope = before * (k / whole) + after * (h / whole);
  return slope * (S(2) * s);
}

// Control points of the chain from the second to the last but one of `p`; steps[i] > 0 lies between p[i]
// and p[i + 1]. Requires four points or more.
template <class V, class S>
std::vector<V> bezier_points(std::span<const V> p, std::span<const S> steps, const S& s) {
  std::vector<V> out{p[1]};
  const auto along = [&](std::size_t i) {
    return tangent(p[i - 1], p[i], p[i + 1], steps[i - 1], steps[i], s);
  };
  V from = along(1);
  for (std::size_t i = 1; i + 2 < p.size(); ++i) {
    const V to = along(i + 1);
    out.push_back(kernels::after_start(p[i], from, steps[i]));
    out.push_back(kernels::before_end(p[i + 1], to, steps[i]));
    out.push_back(p[i + 1]);
    from = to;
  }
  return out;
}

}  // namespace frustum::catmull_rom
