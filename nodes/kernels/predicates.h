#pragma once
// Signs of determinants, exact: a rounded sign flips faces, windings and sides of planes.
// Source: Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust geometric predicates",
// Discrete & Computational Geometry 18:305. Here with one filter and then the exact expansion.

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// A sum kept exactly, as doubles that do not overlap, smallest first. At most `capacity` terms.
template <std::size_t capacity>
class Expansion {
 public:
  void add(double term) {
    for (std::size_t i = 0; i < size_; ++i) {
      const auto [sum, error] = two_sum(terms_[i], term);
      terms_[i] = error;
      term = sum;
    }
    terms_[size_++] = term;
  }
  // -1, 0 or 1: that of the largest term that is not zero.
  int sign() const {
    for (std::size_t i = size_; i-- > 0;)
      if (terms_[i] != 0) return terms_[i] > 0 ? 1 : -1;
    return 0;
  }

 private:
  std::array<double, capacity> terms_{};
  std::size_t size_ = 0;
};

namespace predicate_detail {

// Adds sign x y z, exactly.
template <std::size_t capacity>
void add_product(Expansion<capacity>& sum, double x, double y, double z, double sign) {
  const auto xy = two_product(x, y);
  for (const double part : {xy.hi, xy.lo}) {
    const auto p = two_product(part, sign * z);
    sum.add(p.lo);
    sum.add(p.hi);
  }
}

// Adds sign a . (b x c), exactly: at most 24 terms.
template <std::size_t capacity>
void add_determinant(Expansion<capacity>& sum, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c,
                     double sign) {
  add_product(sum, a.x, b.y, c.z, sign), add_product(sum, a.y, b.z, c.x, sign);
  add_product(sum, a.z, b.x, c.y, sign), add_product(sum, a.z, b.y, c.x, -sign);
  add_product(sum, a.x, b.z, c.y, -sign), add_product(sum, a.y, b.x, c.z, -sign);
}

// All 24 terms of the six triple products. Exact while no product of two nonzero entries' errors underflows:
// entries of a row (scaled to about 1 here) above 2^-300.
inline int determinant_sign_exactly(std::array<glm::dvec3, 3> rows) {
  for (auto& row : rows) {
    const double largest = largest_component(row);
    if (largest == 0) return 0;
    row *= power_of_two_towards_one(largest);
  }
  Expansion<24> sum;
  add_determinant(sum, rows[0], rows[1], rows[2], 1);
  return sum.sign();
}

// All 96 terms of the 4x4 determinant whose last column is 1; each axis is scaled to about 1 first.
inline int orientation_exactly(std::array<glm::dvec3, 4> p) {
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    const double largest = largest_component(glm::dvec4(p[0][axis], p[1][axis], p[2][axis], p[3][axis]));
    if (largest == 0) return 0;
    for (auto& q : p) q[axis] *= power_of_two_towards_one(largest);
  }
  Expansion<96> sum;
  add_determinant(sum, p[0], p[1], p[2], 1), add_determinant(sum, p[0], p[1], p[3], -1);
  add_determinant(sum, p[0], p[2], p[3], 1), add_determinant(sum, p[1], p[2], p[3], -1);
  return sum.sign();
}

}  // namespace predicate_detail

// Sign of det[a; b; c] = a . (b x c): -1, 0 or 1, exact for the numbers given. 0 if any is NaN or infinite.
// Cost: some 30 operations when the sign is clear (all but 1e-14 of random inputs), some 500 operations else.
template <std::floating_point R>
int determinant_sign(const glm::vec<3, R>& a, const glm::vec<3, R>& b, const glm::vec<3, R>& c) {
  const glm::dvec3 p(a), q(b), r(c);
  const double m0 = q.y * r.z, m1 = q.z * r.y, m2 = q.z * r.x, m3 = q.x * r.z, m4 = q.x * r.y, m5 = q.y * r.x;
  const double det = p.x * (m0 - m1) + p.y * (m2 - m3) + p.z * (m4 - m5);
  const double size = std::fabs(p.x) * (std::fabs(m0) + std::fabs(m1)) +
                      std::fabs(p.y) * (std::fabs(m2) + std::fabs(m3)) +
                      std::fabs(p.z) * (std::fabs(m4) + std::fabs(m5));
  // Each term goes through at most 5 roundings; 8 u leaves room for those of `size` itself.
  constexpr double filter = 8 * 0x1p-53;
  if (std::fabs(det) > filter * size && size > 0x1p-900 && size < 0x1p1000) return det > 0 ? 1 : -1;
  if (!std::isfinite(largest_component(p) + largest_component(q) + largest_component(r))) return 0;
  return predicate_detail::determinant_sign_exactly({p, q, r});
}

// 1 if (p, q, r) turn counter-clockwise (y up), -1 if clockwise, 0 if collinear; exact. 0 if any is NaN or
// infinite. Cost: some 10 operations when the sign is clear, some 500 else.
// Source: Shewchuk 1997, section 4.2; the filter is his ccwerrboundA, (3 + 16 u) u, for rounded differences.
template <std::floating_point R>
int orientation(const glm::vec<2, R>& p, const glm::vec<2, R>& q, const glm::vec<2, R>& r) {
  const glm::dvec2 o(r), a = glm::dvec2(p) - o, b = glm::dvec2(q) - o;
  const double left = a.x * b.y, right = a.y * b.x, det = left - right;
  const double size = std::fabs(left) + std::fabs(right);
  constexpr double filter = (3 + 16 * 0x1p-53) * 0x1p-53;
  if (std::fabs(det) > filter * size && size > 0x1p-900 && size < 0x1p1000) return det > 0 ? 1 : -1;
  return determinant_sign<double>({p.x, p.y, 1.0}, {q.x, q.y, 1.0}, {r.x, r.y, 1.0});
}

// On which side of the plane through p, q, r the point s lies: 1 on the side from which they turn clockwise
// (so that (p - s) . ((q - s) x (r - s)) > 0), -1 on the other, 0 in the plane; exact, and antisymmetric in
// its arguments. 0 if any is NaN or infinite. Cost: some 40 operations when the sign is clear, some 20000
// where the points are coplanar to within rounding.
// Source: Shewchuk 1997, section 4.3; the filter's bound is 7 u + O(u^2), u for each rounded difference.
template <std::floating_point R>
int orientation(const glm::vec<3, R>& p, const glm::vec<3, R>& q, const glm::vec<3, R>& r,
                const glm::vec<3, R>& s) {
  const glm::dvec3 o(s), a = glm::dvec3(p) - o, b = glm::dvec3(q) - o, c = glm::dvec3(r) - o;
  const double m0 = b.y * c.z, m1 = b.z * c.y, m2 = b.z * c.x, m3 = b.x * c.z, m4 = b.x * c.y, m5 = b.y * c.x;
  const double det = a.x * (m0 - m1) + a.y * (m2 - m3) + a.z * (m4 - m5);
  const double size = std::fabs(a.x) * (std::fabs(m0) + std::fabs(m1)) +
                      std::fabs(a.y) * (std::fabs(m2) + std::fabs(m3)) +
                      std::fabs(a.z) * (std::fabs(m4) + std::fabs(m5));
  constexpr double filter = 10 * 0x1p-53;
  if (std::fabs(det) > filter * size && size > 0x1p-900 && size < 0x1p1000) return det > 0 ? 1 : -1;
  if (!std::isfinite(largest_component(a) + largest_component(b) + largest_component(c))) return 0;
  return predicate_detail::orientation_exactly({glm::dvec3(p), glm::dvec3(q), glm::dvec3(r), o});
}

}  // namespace frustum::kernels
