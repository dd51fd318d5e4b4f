// The three forms of a line through two points of the plane (z is not looked at), y up.
#pragma once

#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

namespace frustum::vector {

// y = m x + b. Each within 2 ulp where nothing overflows.
struct Explicit {
  double m, b;
};

// Nothing for a vertical line, which is no function of x, and where m or b leaves the range of double.
inline std::optional<Explicit> explicit_form(const glm::dvec2& p, const glm::dvec2& q) {
  if (p.x == q.x) return std::nullopt;
  const auto dx = kernels::two_sum(q.x, -p.x), dy = kernels::two_sum(q.y, -p.y);
  // b = (p.y q.x - q.y p.x) / dx: no point is subtracted from a rounded slope times a coordinate.
  const auto c = kernels::plus(kernels::two_product(p.y, q.x), kernels::two_product(-q.y, p.x));
  const Explicit e{kernels::quotient(dy, dx).hi, kernels::quotient(c, dx).hi};
  if (!std::isfinite(e.m) || !std::isfinite(e.b)) return std::nullopt;
  return e;
}

// f(q) = (x - x0) dy - (y - y0) dx, to twice the precision: relative error below 2^-45 where the products are
// above 2^-900 and f is not smaller than 2^-50 of them. Its sign may still be wrong: ask side_of.
inline double implicit_value(const glm::dvec2& p0, const glm::dvec2& p1, const glm::dvec2& q) {
  const auto x = kernels::two_sum(q.x, -p0.x), y = kernels::two_sum(q.y, -p0.y);
  const auto dx = kernels::two_sum(p1.x, -p0.x), dy = kernels::two_sum(p1.y, -p0.y);
  const auto right = kernels::product(y, dx);
  return kernels::plus(kernels::product(x, dy), {-right.hi, -right.lo}).hi;
}

// The same in one go of double: the naive form, whose sign is noise near the line.
inline double plain_implicit_value(const glm::dvec2& p0, const glm::dvec2& p1, const glm::dvec2& q) {
  return (q.x - p0.x) * (p1.y - p0.y) - (q.y - p0.y) * (p1.x - p0.x);
}

// 1 where q lies to the left of the way from p0 to p1 (f < 0), -1 to its right, 0 on the line; exact.
inline int side_of(const glm::dvec2& p0, const glm::dvec2& p1, const glm::dvec2& q) {
  return kernels::orientation(p0, p1, q);
}

// 1 above the line, -1 below, whichever way it runs; 0 on it, and anywhere beside a vertical one. Errata E4: with y
// up and dx > 0 it is f < 0 that is above.
inline int above(const glm::dvec2& p0, const glm::dvec2& p1, const glm::dvec2& q) {
  const int side = side_of(p0, p1, q);
  return p1.x > p0.x ? side : p1.x < p0.x ? -side : 0;
}

// p(0) = p0 and p(1) = p1 bit for bit, monotonic in each coordinate. p0 + t (p1 - p0) misses p1 for every sixth
// pair of floats.
inline glm::dvec3 parametric(const glm::dvec3& p0, const glm::dvec3& p1, double t) {
  return kernels::lerp(p0, p1, t);
}

}  // namespace frustum::vector
