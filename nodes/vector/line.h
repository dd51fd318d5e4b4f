// The three forms of a line through two points of the plane (z is not looked at), y up.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <tuple>

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

// Where two lines p0 p1 and q0 q1 meet.
struct Meeting {
  glm::dvec2 at;
  double t, s;       // at = p0 + t (p1 - p0) = q0 + s (q1 - q0)
  double condition;  // 1 / |sin| of the angle between them: by what rounding of the points is enlarged
};

namespace line_detail {

using Two = kernels::TwoTerms<double>;

// From one point to another, exact.
struct Way {
  Two x, y;
  Way(const glm::dvec2& from, const glm::dvec2& to)
      : x(kernels::two_sum(to.x, -from.x)), y(kernels::two_sum(to.y, -from.y)) {}
  double length() const { return kernels::norm(glm::dvec2(x.hi, y.hi)); }
};

inline Two cross(const Way& a, const Way& b) {
  const Two right = kernels::product(a.y, b.x);
  return kernels::plus(kernels::product(a.x, b.y), {-right.hi, -right.lo});
}

// Whether a x b is 0, given its rounded value. That is off by less than 2^-99 of its products, which decides all but
// what cancels wholly; then the sign is that of the 16 exact terms.
inline bool parallel(const Way& a, const Way& b, const Two& area) {
  const double terms = std::fabs(a.x.hi * b.y.hi) + std::fabs(a.y.hi * b.x.hi);
  if (std::fabs(area.hi) > 0x1p-96 * terms) return false;
  kernels::Expansion<16> exact;
  const auto add = [&](const Two& u, const Two& v, double sign) {
    for (const double p : {u.hi, u.lo})
      for (const double q : {v.hi, v.lo}) {
        const Two both = kernels::two_product(p, sign * q);
        exact.add(both.lo), exact.add(both.hi);
      }
  };
  add(a.x, b.y, 1), add(a.y, b.x, -1);
  return exact.sign() == 0;
}

}  // namespace line_detail

// Nothing for parallel lines, which is decided exactly; for lines that are none (p0 = p1), for NaN and infinity, and
// for a meeting beyond the range of double. `at` within 2 u of the largest coordinate times the condition, and mostly
// within an ulp of where the lines through the given points meet. Requires coordinates that are 0 or above 2^-300 of
// the largest. Cost: some 300 operations, and some 1000 where the lines are parallel.
// Source: Hoffmann 1989, Geometric and Solid Modeling, chapter 4. Departure: differences and products are kept in
// twice the precision, so that how far the points are from the origin does not count.
inline std::optional<Meeting> meeting_of(glm::dvec2 p0, glm::dvec2 p1, glm::dvec2 q0, glm::dvec2 q1) {
  using line_detail::Two;
  const double largest = std::max({kernels::largest_component(p0), kernels::largest_component(p1),
                                   kernels::largest_component(q0), kernels::largest_component(q1)});
  if (!(largest > 0) || !std::isfinite(p0.x + p0.y + p1.x + p1.y + q0.x + q0.y + q1.x + q1.y))
    return std::nullopt;
  const double scale = kernels::power_of_two_towards_one(largest);
  for (glm::dvec2* p : {&p0, &p1, &q0, &q1}) *p *= scale;
  const line_detail::Way d(p0, p1), e(q0, q1), between(p0, q0);
  const Two area = cross(d, e);
  if (parallel(d, e, area)) return std::nullopt;
  const Two t = kernels::quotient(cross(between, e), area), s = kernels::quotient(cross(between, d), area);
  const auto along = [&](double from, const Two& length) {
    return kernels::plus(Two{from, 0}, kernels::product(t, length)).hi / scale;
  };
  const Meeting m{{along(p0.x, d.x), along(p0.y, d.y)},
                  t.hi,
                  s.hi,
                  std::max(1.0, d.length() * e.length() / std::fabs(area.hi))};
  if (!std::isfinite(m.at.x) || !std::isfinite(m.at.y)) return std::nullopt;
  return m;
}

// p(0) = p0 and p(1) = p1 bit for bit, monotonic in each coordinate. p0 + t (p1 - p0) misses p1 for every sixth
// pair of floats.
inline glm::dvec3 parametric(const glm::dvec3& p0, const glm::dvec3& p1, double t) {
  return kernels::lerp(p0, p1, t);
}

}  // namespace frustum::vector
