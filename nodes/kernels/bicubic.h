// Bicubic Bezier patches: points, derivatives, normals also where the parametrisation breaks down, and
// bounds.
#pragma once

#include "nodes/kernels/vector.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace frustum::kernels {

/// Control point 4 i + j belongs to row i (u) and column j (v); (u, v) in [0, 1]^2. Errata E61: rows are p0
/// p1 p2 p3.
using BicubicNet = std::array<glm::dvec3, 16>;

/// The k-th derivatives of the four cubic Bernstein polynomials at t, k from 0 to 3.
inline std::array<double, 4> bernstein3(double t, int k) {
  const double s = 1 - t;
  switch (k) {
    case 0: return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    case 1: return {-3 * s * s, 3 * s * s - 6 * s * t, 6 * s * t - 3 * t * t, 3 * t * t};
    case 2: return {6 * s, 6 * t - 12 * s, 6 * s - 12 * t, 6 * t};
    default: return {-6, 18, -18, 6};
  }
}

/// The point of a cubic at t; exactly p[0] at 0 and p[3] at 1.
inline glm::dvec3 cubic_point(const std::array<glm::dvec3, 4>& p, double t) {
  const auto b = bernstein3(t, 0);
  return p[0] * b[0] + p[1] * b[1] + p[2] * b[2] + p[3] * b[3];
}

/// d^(i+j) P / du^i dv^j at (u, v); the point itself for i = j = 0. i and j from 0 to 3.
inline glm::dvec3 bicubic_derivative(const BicubicNet& net, double u, double v, int i, int j) {
  const auto bu = bernstein3(u, i), bv = bernstein3(v, j);
  glm::dvec3 sum{0};
  for (std::size_t r = 0; r < 4; ++r)
    sum += (net[4 * r] * bv[0] + net[4 * r + 1] * bv[1] + net[4 * r + 2] * bv[2] + net[4 * r + 3] * bv[3]) *
           bu[r];
  return sum;
}

/// Half the diagonal of the box around the net.
inline double net_extent(const BicubicNet& net) {
  glm::dvec3 low = net[0], high = net[0];
  for (const glm::dvec3& p : net)
    for (int c = 0; c < 3; ++c) low[c] = std::min(low[c], p[c]), high[c] = std::max(high[c], p[c]);
  return 0.5 * norm(high - low);
}

/// The unit normal along dP/du x dP/dv. Where that vanishes (errata E72: a collapsed edge, parallel tangents)
/// it is the limit from the inside of the patch: with c(t) = dP/du x dP/dv at (u, v) + t (a, b), the first
/// Taylor coefficient c', c''/2 of c that is not zero points the way of c(t) for small t > 0. (0, 0, 1) where
/// all three vanish: the patch has no area there.
///   extent  net_extent(net)
inline glm::dvec3 bicubic_normal(const BicubicNet& net, double extent, double u, double v) {
  const auto d = [&](int i, int j) { return bicubic_derivative(net, u, v, i, j); };
  // Derivatives carry rounding errors of some 10 u extent, so a product below 2^-30 of what it could be has
  // no direction left that can be told from noise at the accuracy of a float normal.
  constexpr double vanishing = 0x1p-30;
  const glm::dvec3 pu = d(1, 0), pv = d(0, 1);
  const double larger = std::max(norm(pu), norm(pv));
  const glm::dvec3 c0 = cross(pu, pv);
  if (norm(c0) > vanishing * extent * std::max(larger, vanishing * extent))
    return normalized_or(c0, {0, 0, 1});

  const auto inwards = [](double t) { return t <= 0 ? 1.0 : (t >= 1 ? -1.0 : 0.0); };
  double a = inwards(u), b = inwards(v);
  if (a == 0 && b == 0) a = u < 0.5 ? 1 : -1;
  const glm::dvec3 puv = d(1, 1);
  const glm::dvec3 du = d(2, 0) * a + puv * b, dv = puv * a + d(0, 2) * b;
  const glm::dvec3 c1 = cross(du, pv) + cross(pu, dv);
  if (norm(c1) > vanishing * extent * extent) return normalized_or(c1, {0, 0, 1});

  const glm::dvec3 puuv = d(2, 1), puvv = d(1, 2);
  const glm::dvec3 ddu = d(3, 0) * (a * a) + puuv * (2 * a * b) + puvv * (b * b);
  const glm::dvec3 ddv = puuv * (a * a) + puvv * (2 * a * b) + d(0, 3) * (b * b);
  const glm::dvec3 c2 = cross(ddu, pv) * 0.5 + cross(du, dv) + cross(pu, ddv) * 0.5;
  if (norm(c2) > vanishing * extent * extent) return normalized_or(c2, {0, 0, 1});
  return {0, 0, 1};
}

/// Upper bounds of |d2P/du2|, |d2P/dudv|, |d2P/dv2| over the patch: derivatives are Bezier patches whose
/// control points are 6 and 9 times the second differences, and a patch lies in the hull of its control
/// points.
struct SecondDerivatives {
  double uu = 0, uv = 0, vv = 0;
};
inline SecondDerivatives bound_second_derivatives(const BicubicNet& net) {
  const auto at = [&](std::size_t i, std::size_t j) { return net[4 * i + j]; };
  SecondDerivatives m;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) {
      if (i < 2) m.uu = std::max(m.uu, 6 * norm(at(i, j) - at(i + 1, j) * 2.0 + at(i + 2, j)));
      if (j < 2) m.vv = std::max(m.vv, 6 * norm(at(i, j) - at(i, j + 1) * 2.0 + at(i, j + 2)));
      if (i < 3 && j < 3)
        m.uv = std::max(m.uv, 9 * norm(at(i, j) - at(i + 1, j) - at(i, j + 1) + at(i + 1, j + 1)));
    }
  return m;
}

}  // namespace frustum::kernels
