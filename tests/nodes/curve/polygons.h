// Control polygons for the tests of nodes/curve, and the rationals in which they can be checked.
#pragma once

#include "nodes/curve.h"
#include "runtime/buffers/curve.h"
#include "tests/hard/exact.h"
#include "tests/nodes/vector/rows.h"

#include <vector>

namespace frustum::test {

using hard::Rational;

inline std::vector<glm::dvec3> random_polygon(std::mt19937_64& random, std::size_t points, double size = 1) {
  std::vector<glm::dvec3> p;
  for (std::size_t i = 0; i < points; ++i) p.push_back(random_row(random, size));
  return p;
}

inline double largest(std::span<const glm::dvec3> p) {
  double most = 0;
  for (const glm::dvec3& q : p) most = std::max(most, kernels::largest_component(q));
  return most;
}

inline std::vector<Rational> coordinate(std::span<const glm::dvec3> p, glm::length_t axis) {
  std::vector<Rational> out;
  for (const glm::dvec3& q : p) out.emplace_back(q[axis]);
  return out;
}

// sum binomial(n, i) t^i (1 - t)^(n - i) c_i, term by term.
inline Rational bernstein_sum(std::span<const Rational> c, const Rational& t) {
  const std::size_t n = c.size() - 1;
  Rational sum = 0, choose = 1;
  std::vector<Rational> away{Rational(1)};
  for (std::size_t i = 0; i < n; ++i) away.emplace_back(away.back() * (1 - t));
  Rational power = 1;
  for (std::size_t i = 0; i <= n; ++i) {
    sum += choose * power * away[n - i] * c[i];
    power *= t;
    choose = choose * static_cast<unsigned long>(n - i) / static_cast<unsigned long>(i + 1);
  }
  return sum;
}

// The same number, |got - want|, in double.
inline double off(double got, const Rational& want) {
  return std::isfinite(got) ? std::fabs(Rational(Rational(got) - want).get_d()) : INFINITY;
}

// The node's outputs in double precision.
inline std::vector<Buffer> run_double(const NodeType& type, const Json& params,
                                      const NodeInputs& inputs = {}) {
  Context ctx;
  ctx.precision = Precision::real_double;
  return run_node(type, params, inputs, &ctx);
}

inline Json rows(std::span<const glm::dvec3> p) {
  Json out = Json::array();
  for (const glm::dvec3& q : p) out.push_back({q.x, q.y, q.z});
  return out;
}

// Derivatives 0 to 2 of a curve.
inline std::array<glm::dvec3, 3> jet(const Curve& c, double t,
                                     kernels::KnotSide side = kernels::KnotSide::after) {
  std::array<glm::dvec3, 3> out;
  kernels::SplinePoints<double>(c.spline()).at(t, out, side);
  return out;
}

inline Ref<Curve> curve_of(Curve c) { return std::make_shared<const Curve>(std::move(c)); }

}  // namespace frustum::test
