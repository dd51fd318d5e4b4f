#pragma once
// Affine maps that carry their inverse along. Each elementary map knows its inverse from its structure, and
// the inverse of a product is the product of the inverses reversed: nothing is ever solved for, nothing lost.

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <utility>

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/matrix.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// p -> linear p + translation, and back: q -> inverse_linear q + inverse_translation.
struct Affine {
  glm::dmat3 linear{1.0}, inverse_linear{1.0};
  glm::dvec3 translation{0.0}, inverse_translation{0.0};
};

inline Affine inverse(const Affine& a) {
  return {a.inverse_linear, a.linear, a.inverse_translation, a.translation};
}

// First `inner`, then `outer`.
inline Affine composed(const Affine& outer, const Affine& inner) {
  return {outer.linear * inner.linear, inner.inverse_linear * outer.inverse_linear,
          outer.linear * inner.translation + outer.translation,
          inner.inverse_linear * outer.inverse_translation + inner.inverse_translation};
}

inline glm::dmat4 matrix_of(const Affine& a) {
  glm::dmat4 m(1.0);
  for (glm::length_t c = 0; c < 3; ++c) m[c] = glm::dvec4(a.linear[c], 0);
  m[3] = glm::dvec4(a.translation, 1);
  return m;
}

// Takes normals along: the transpose of the inverse, from the structure, whatever the scale. The result is
// not of unit length, and keeps its side of the surface under reflections.
inline glm::dmat3 normal_matrix(const Affine& a) { return glm::transpose(a.inverse_linear); }

// Whether the map turns a right hand into a left one; exact sign of the determinant.
inline bool mirrors(const Affine& a) { return determinant_sign(a.linear[0], a.linear[1], a.linear[2]) < 0; }

// What one knows of the condition: 1 / (|L| |L^-1|) in the 1-norm. A pure scale by 1e-20 has 1.
inline double rcond(const Affine& a) {
  return 1 / (matrix_detail::one_norm<3>(a.linear) * matrix_detail::one_norm<3>(a.inverse_linear));
}

inline Affine translation(const glm::dvec3& t) {
  Affine a;
  a.translation = t;
  a.inverse_translation = -t;
  return a;
}

// Nothing where a factor is zero or its reciprocal out of range (below 2^-1022).
inline std::optional<Affine> scaling(const glm::dvec3& s) {
  Affine a;
  for (glm::length_t i = 0; i < 3; ++i) {
    a.linear[i][i] = s[i];
    a.inverse_linear[i][i] = 1 / s[i];
    if (!std::isfinite(s[i]) || !std::isfinite(1 / s[i])) return std::nullopt;
  }
  return a;
}

// Moves points along axis `moved` (0 x, 1 y, 2 z) by `amount` times their coordinate `by`; the inverse takes
// -amount, exactly. Requires moved != by.
inline Affine shearing(int moved, int by, double amount) {
  Affine a;
  a.linear[by][moved] = amount;
  a.inverse_linear[by][moved] = -amount;
  return a;
}

inline Affine rotation_of(const glm::dmat3& orthonormal) {
  Affine a;
  a.linear = orthonormal;
  a.inverse_linear = glm::transpose(orthonormal);
  return a;
}

// The rotation of a quaternion of some length about 1, its terms to twice the precision: each entry is the
// exact one for that quaternion, rounded, unless it is as small as 2^-50 by cancellation. |R^T R - I| <= 3 u.
inline Affine rotation_of_quaternion(TwoTerms<double> a, TwoTerms<double> b, TwoTerms<double> c,
                                     TwoTerms<double> d) {
  const auto less = [](TwoTerms<double> p, TwoTerms<double> q) { return plus(p, {0 - q.hi, 0 - q.lo}); };
  const auto aa = product(a, a), bb = product(b, b), cc = product(c, c), dd = product(d, d);
  const auto ab = product(a, b), ac = product(a, c), ad = product(a, d);
  const auto bc = product(b, c), bd = product(b, d), cd = product(c, d);
  const auto n = plus(plus(aa, bb), plus(cc, dd));
  const auto entry = [&](TwoTerms<double> p) { return quotient(p, n).hi; };
  glm::dmat3 m;
  m[0] = {entry(plus(less(aa, dd), less(bb, cc))), 2 * entry(plus(bc, ad)), 2 * entry(less(bd, ac))};
  m[1] = {2 * entry(less(bc, ad)), entry(plus(less(aa, bb), less(cc, dd))), 2 * entry(plus(cd, ab))};
  m[2] = {2 * entry(plus(bd, ac)), 2 * entry(less(cd, ab)), entry(plus(less(aa, bb), less(dd, cc)))};
  for (glm::length_t i = 0; i < 3; ++i) m[i] += 0.0;  // no negative zeros
  return rotation_of(m);
}

// The rotation of the quaternion w + x i + y j + z k, of any length but 0 (then nothing). Dividing by the
// squared length instead of normalising keeps quarter turns such as (1, 1, 0, 0) exact.
inline std::optional<Affine> quaternion_rotation(double w, const glm::dvec3& v) {
  const double largest = largest_component(glm::dvec4(v, w));
  if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
  const double scale = power_of_two_towards_one(largest);
  return rotation_of_quaternion({w * scale, 0}, {v.x * scale, 0}, {v.y * scale, 0}, {v.z * scale, 0});
}

// Counter-clockwise seen against the axis, through the quaternion (|axis| cos h, axis sin h) of half the
// angle, whose length divides out: the axis is never rounded to unit length. |R^T R - I| <= 3 u and entries
// within 4 ulp, where Rodrigues' formula with a rounded axis reaches 19 u. Multiples of 90 degrees about a
// coordinate axis have entries 0, 1 and -1 exactly. Nothing where the axis has no direction.
inline std::optional<Affine> rotation(const glm::dvec3& axis, double degrees) {
  const double largest = largest_component(axis);
  if (!(largest > 0) || !std::isfinite(largest) || !std::isfinite(degrees)) return std::nullopt;
  const glm::dvec3 v = axis * power_of_two_towards_one(largest);
  const auto square = plus(plus(two_product(v.x, v.x), two_product(v.y, v.y)), two_product(v.z, v.z));
  const double root = std::sqrt(square.hi);
  const auto rest = plus(square, two_product(-root, root));
  const TwoTerms<double> length = fast_two_sum(root, rest.hi / (2 * root));

  const auto [s, c] = sin_cos_degrees(degrees);
  if (s == 0) return c > 0 ? Affine{} : rotation_of_quaternion({0, 0}, {v.x, 0}, {v.y, 0}, {v.z, 0});
  if (c == 0) return rotation_of_quaternion(length, {v.x * s, 0}, {v.y * s, 0}, {v.z * s, 0});
  const auto half = elementary::turned(elementary::reduce_degrees(degrees / 2));
  const auto times_sine = [&](double x) { return product(half.sin, {x, 0}); };
  return rotation_of_quaternion(product(length, half.cos), times_sine(v.x), times_sine(v.y), times_sine(v.z));
}

// The order in which the three turns are made, each about a fixed axis: xyz turns about x first.
enum class EulerOrder : std::uint8_t { xyz, xzy, yxz, yzx, zxy, zyx };

constexpr std::array<glm::length_t, 3> axes_of(EulerOrder order) {
  switch (order) {
    case EulerOrder::xyz: return {0, 1, 2};
    case EulerOrder::xzy: return {0, 2, 1};
    case EulerOrder::yxz: return {1, 0, 2};
    case EulerOrder::yzx: return {1, 2, 0};
    case EulerOrder::zxy: return {2, 0, 1};
    case EulerOrder::zyx: return {2, 1, 0};
  }
  return {0, 1, 2};
}

// The turns about x, y and z are degrees.x, .y and .z, made in `order`. Nothing where an angle is not finite.
inline std::optional<Affine> euler_rotation(const glm::dvec3& degrees, EulerOrder order) {
  Affine all;
  for (const glm::length_t axis : axes_of(order)) {
    glm::dvec3 unit(0.0);
    unit[axis] = 1;
    const auto turn = rotation(unit, degrees[axis]);
    if (!turn) return std::nullopt;
    all = composed(*turn, all);
  }
  return all;
}

// How far three Euler angles are from gimbal lock: |cos| of the middle turn, the Jacobian's determinant. At 0
// the first and the last turn are about the same axis, and one degree of freedom is gone; below about 1e-6
// they are no longer told apart in single precision.
inline double gimbal_freedom(const glm::dvec3& degrees, EulerOrder order) {
  return std::fabs(sin_cos_degrees(degrees[axes_of(order)[1]]).cos);
}

// A map given as a matrix that acts on column vectors. Nothing where the last row is not 0 0 0 1, a number is
// not finite, or the linear part is singular, which is decided exactly.
inline std::optional<Affine> affine_from_matrix(const glm::dmat4& m) {
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) return std::nullopt;
  Affine a;
  a.linear = glm::dmat3(m);
  a.translation = glm::dvec3(m[3]);
  const auto back = inverse<3>(a.linear);
  if (!back || !std::isfinite(largest_component(a.translation))) return std::nullopt;
  a.inverse_linear = back->matrix;
  a.inverse_translation = -(back->matrix * a.translation);
  return a;
}

// The map in the precision of a buffer, ready to apply. Sums run x, y, z, translation.
template <std::floating_point R>
struct PointMap {
  explicit PointMap(const Affine& a) : linear(a.linear), translation(a.translation) {}
  glm::vec<3, R> operator()(const glm::vec<3, R>& p) const {
    return ((linear[0] * p.x + linear[1] * p.y) + linear[2] * p.z) + translation;
  }
  glm::mat<3, 3, R> linear;
  glm::vec<3, R> translation;
};

}  // namespace frustum::kernels
