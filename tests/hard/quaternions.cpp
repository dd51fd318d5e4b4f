// Transforms: rotations as quaternions.
#include "nodes/kernels/affine.h"
#include "nodes/kernels/quaternion.h"
#include "nodes/transform/slerp.h"
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace frustum::hard {
namespace {

using glm::dmat3, glm::dvec3, glm::dvec4;
using Quaternion = std::array<Real, 4>;  // w, x, y, z

constexpr double infinity = std::numeric_limits<double>::infinity();

// |got - want| or |got + want|, whichever is smaller: both signs are the same rotation. Infinite for NaN.
double apart(const dvec4& got, const Quaternion& want) {
  Real less, more;
  for (std::size_t i = 0; i < 4; ++i) {
    const double g = got[static_cast<glm::length_t>(i)];
    if (!std::isfinite(g)) return infinity;
    less = less + (Real(g) - want[i]) * (Real(g) - want[i]);
    more = more + (Real(g) + want[i]) * (Real(g) + want[i]);
  }
  return std::sqrt(std::min(less.to_double(), more.to_double()));
}

// The rotation by pi - `short_of` about an axis: its matrix, correctly rounded, and its quaternion.
struct Turn {
  dmat3 matrix;
  Quaternion q;
};
Turn turn(const dvec3& axis, double short_of) {
  const Real half = (pi() - Real(short_of)) / 2.0;
  const Real length = sqrt(Real(axis.x) * axis.x + Real(axis.y) * axis.y + Real(axis.z) * axis.z);
  const Quaternion q{cos(half), sin(half) * axis.x / length, sin(half) * axis.y / length,
                     sin(half) * axis.z / length};
  const auto product = [&](std::size_t i, std::size_t j) { return (Real(2.0) * q[i] * q[j]); };
  const auto entry = [&](const Real& v) { return v.to_double(); };
  const Real one = 1.0;
  return {dmat3(entry(one - product(2, 2) - product(3, 3)), entry(product(1, 2) + product(0, 3)),
                entry(product(1, 3) - product(0, 2)), entry(product(1, 2) - product(0, 3)),
                entry(one - product(1, 1) - product(3, 3)), entry(product(2, 3) + product(0, 1)),
                entry(product(1, 3) + product(0, 2)), entry(product(2, 3) - product(0, 1)),
                entry(one - product(1, 1) - product(2, 2))),
          q};
}

// The scalar part from the trace, and the others divided by it.
dvec4 from_the_trace(const dmat3& r) {
  const double w = std::sqrt(1 + r[0][0] + r[1][1] + r[2][2]) / 2;
  return {w, (r[1][2] - r[2][1]) / (4 * w), (r[2][0] - r[0][2]) / (4 * w), (r[0][1] - r[1][0]) / (4 * w)};
}

void quaternion_of_half_a_turn(Trial& t) {
  std::vector<dmat3> matrices;
  const auto judge = [&](const dvec3& axis, double short_of) {
    const Turn exact = turn(axis, short_of);
    t.measure(apart(from_the_trace(exact.matrix), exact.q) / u64,
              apart(kernels::quaternion_of(exact.matrix), exact.q) / u64, {axis.x, axis.y, axis.z, short_of});
    matrices.push_back(exact.matrix);
  };
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        for (const double short_of : {0.0, 1e-4, 1e-8, 1e-12, 1.0, 3.0})
          if (x != 0 || y != 0 || z != 0) judge(dvec3(x, y, z), short_of);
  for (std::size_t n = t.samples(300, 30000); n-- > 0;)
    judge({t.random.uniform(-1, 1), t.random.uniform(-1, 1), t.random.uniform(-1, 1)},
          std::fabs(t.random.magnitude(-45, 1)));
  t.price_over(matrices, from_the_trace, kernels::quaternion_of);
}

// Shoemake's formula with the angle from the product.
dvec4 by_acos(const dvec4& a, const dvec4& b, double t) {
  const double angle = std::acos(kernels::dot(a, b));
  return a * (std::sin((1 - t) * angle) / std::sin(angle)) + b * (std::sin(t * angle) / std::sin(angle));
}

Quaternion exact_slerp(const dvec4& a, const dvec4& b, double t) {
  Real dot, aa, bb;
  for (glm::length_t i = 0; i < 4; ++i)
    dot = dot + Real(a[i]) * b[i], aa = aa + Real(a[i]) * a[i], bb = bb + Real(b[i]) * b[i];
  const bool turned = dot < Real(0.0);
  Real apart2, sum2;  // |a - b|^2, |a + b|^2 of the unit vectors along both
  Quaternion p, q;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto k = static_cast<glm::length_t>(i);
    p[i] = Real(a[k]) / sqrt(aa), q[i] = Real(turned ? -b[k] : b[k]) / sqrt(bb);
    apart2 = apart2 + (p[i] - q[i]) * (p[i] - q[i]), sum2 = sum2 + (p[i] + q[i]) * (p[i] + q[i]);
  }
  const Real angle = Real(2.0) * atan2(sqrt(apart2), sqrt(sum2));
  if (angle.is_zero()) return p;
  const Real from = sin(angle * (Real(1.0) - Real(t))) / sin(angle), to = sin(angle * Real(t)) / sin(angle);
  for (std::size_t i = 0; i < 4; ++i) p[i] = p[i] * from + q[i] * to;
  return p;
}

double off_unit(const dvec4& q) {
  Real square;
  for (glm::length_t i = 0; i < 4; ++i) square = square + Real(q[i]) * q[i];
  return std::fabs((sqrt(square) - Real(1.0)).to_double());
}

struct Pair {
  dvec4 a, b;
  double t;
};

dvec4 unit(Trial& t) {
  const dvec4 v(t.random.uniform(-1, 1), t.random.uniform(-1, 1), t.random.uniform(-1, 1),
                t.random.uniform(-1, 1));
  return v / kernels::norm(v);
}

void slerp_of_nearly_equal(Trial& t) {
  std::vector<Pair> pairs;
  const auto judge = [&](const dvec4& a, const dvec4& b, double s) {
    const Quaternion want = exact_slerp(a, b, s);
    const dvec4 got = transform::slerp(a, b, s), back = transform::slerp(b, a, 1 - s);
    t.measure(apart(by_acos(a, b, s), want) / u64, apart(got, want) / u64, {a.x, a.y, a.z, a.w, b.x, s});
    t.require(off_unit(got) <= 2 * u64, "unit to 2 u", {a.x, b.x, s});
    const double symmetric = std::min(kernels::norm(got - back), kernels::norm(got + back));
    t.require(symmetric <= 4 * u64, "slerp(a, b, t) is slerp(b, a, 1 - t) to 4 u", {a.x, b.x, s});
    pairs.push_back({a, b, s});
  };
  for (std::size_t n = t.samples(200, 20000); n-- > 0;) {
    const dvec4 a = unit(t), off = unit(t);
    const double s = std::ldexp(static_cast<double>(t.random.below(65)), -6);  // 1 - s is exact
    judge(a, a, s);
    judge(a, -a, s);
    for (const double sign : {1.0, -1.0}) {
      const dvec4 b = a + off * std::fabs(t.random.magnitude(-60, -1));
      judge(a, b * (sign / kernels::norm(b)), s);
    }
  }
  t.price_over(
      pairs, [](const Pair& p) { return by_acos(p.a, p.b, p.t); },
      [](const Pair& p) { return transform::slerp(p.a, p.b, p.t); });
}

}  // namespace

std::vector<HardCase> quaternions() {
  return {
      {"XFM-06", "pi, pi - 1e-4 and less about 26 axes of signs and random ones; matrices correctly rounded",
       "w = sqrt(1 + trace) / 2, the others divided by 4 w, double", "kernels::quaternion_of", "MPFR",
       "|q - q*| <= 4 u up to sign", "u", 4, quaternion_of_half_a_turn},
      {"XFM-08", "q with itself, with -q, and with what lies 2^-60 to 1/2 from either",
       "sin((1 - t) x) / sin(x), x = acos(a.b), double", "transform::slerp", "MPFR",
       "within 4 u; unit to 2 u; slerp(a, b, t) = slerp(b, a, 1 - t) to 4 u", "u", 4, slerp_of_nearly_equal},
  };
}

}  // namespace frustum::hard
