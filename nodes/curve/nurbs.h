// Weights that a rational curve can have, and what a projective map makes of its points.
#pragma once

#include <algorithm>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/spline.h"

namespace frustum::nurbs {

using Interval = std::pair<double, double>;

// Where the polynomial with these Bernstein coefficients over [a, b] vanishes inside: an interval of at
// most 2^-42 of the first, or one number; nothing where it has one sign. Coefficients that are nowhere
// below 0, and not all 0, leave no root inside. Roots where signs do not change are found at midpoints, or
// as a narrow interval.
inline std::optional<Interval> root_inside(std::span<const double> c, double a, double b, int depth = 42) {
  const bool positive = std::any_of(c.begin(), c.end(), [](double x) { return x > 0; });
  const bool negative = std::any_of(c.begin(), c.end(), [](double x) { return x < 0; });
  if (positive != negative) return std::nullopt;
  if (!positive || depth == 0) return Interval{a, b};
  std::vector<double> right(c.begin(), c.end()), left{right.front()};
  for (std::size_t level = 1; level < c.size(); ++level) {
    for (std::size_t i = 0; i + level < c.size(); ++i) right[i] = right[i] / 2 + right[i + 1] / 2;
    left.push_back(right[0]);
  }
  const double middle = a + (b - a) / 2;
  if (left.back() == 0) return Interval{middle, middle};
  if (const auto found = root_inside(left, a, middle, depth - 1)) return found;
  return root_inside(right, middle, b, depth - 1);
}

// Where the denominator of a curve vanishes: inside a span, or at a knot between two. At the curve's own
// ends it may.
inline std::optional<Interval> pole(const kernels::Spline& s) {
  for (const std::size_t span : kernels::spans_of(s)) {
    const double a = s.knots[span], b = s.knots[span + 1];
    std::vector<double> w;
    for (const glm::dvec4& h : kernels::bezier_points(s, span, a, b)) w.push_back(h.w);
    if (const auto found = root_inside(w, a, b)) return found;
    if (w.back() == 0 && b < s.last()) return Interval{b, b};
    if (w.front() == 0 && a > s.first()) return Interval{a, a};
  }
  return std::nullopt;
}

// m (w P, w) as a point and its weight; nothing where the weight becomes 0. A curve maps as its points do
// only where the weights are mapped as well (errata E71).
inline std::optional<std::pair<glm::dvec3, double>> projected(const glm::dmat4& m, const glm::dvec3& p,
                                                              double w) {
  glm::dvec4 h;
  for (glm::length_t r = 0; r < 4; ++r) h[r] = m[0][r] * p.x + m[1][r] * p.y + m[2][r] * p.z + m[3][r];
  if (!(h.w != 0)) return std::nullopt;
  return std::pair{glm::dvec3(h) / h.w, h.w * w};
}

}  // namespace frustum::nurbs
