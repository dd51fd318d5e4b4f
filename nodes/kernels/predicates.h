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

// All 24 terms of the six triple products. Exact while no product of two nonzero entries' errors underflows:
// entries of a row (scaled to about 1 here) above 2^-300.
inline int determinant_sign_exactly(std::array<glm::dvec3, 3> rows) {
  for (auto& row : rows) {
    const double largest = largest_component(row);
    if (largest == 0) return 0;
    row *= power_of_two_towards_one(largest);
  }
  const auto& [a, b, c] = rows;
  Expansion<24> sum;
  const auto add = [&sum](double x, double y, double z, double sign) {
    const auto xy = two_product(x, y);
    for (const double part : {xy.hi, xy.lo}) {
      const auto p = two_product(part, sign * z);
      sum.add(p.lo);
      sum.add(p.hi);
    }
  };
  add(a.x, b.y, c.z, 1), add(a.y, b.z, c.x, 1), add(a.z, b.x, c.y, 1);
  add(a.z, b.y, c.x, -1), add(a.x, b.z, c.y, -1), add(a.y, b.x, c.z, -1);
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

// 1 if (p, q, r) turn counter-clockwise (y up), -1 if clockwise, 0 if collinear; exact.
template <std::floating_point R>
int orientation(const glm::vec<2, R>& p, const glm::vec<2, R>& q, const glm::vec<2, R>& r) {
  return determinant_sign<double>({p.x, p.y, 1.0}, {q.x, q.y, 1.0}, {r.x, r.y, 1.0});
}

}  // namespace frustum::kernels
