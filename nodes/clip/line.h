// The part of a segment inside half-spaces, by its parameter: the interval [0, 1] shrinks from plane to
// plane.
//
// A plane is a row n: points (x, y, z, w) with n . p >= 0 are inside. The distances at both ends, d0 and d1,
// say all: the segment enters where d0 < 0 <= d1, leaves where d1 < 0 <= d0, at t = d0 / (d0 - d1), and is
// gone where both are negative. Which of two crossings comes first is the sign of d0 d1' - d0' d1, and every
// sign is exact for the numbers given: no t is compared that was rounded, and nothing is divided where a
// segment is parallel to a plane (d0 = d1). So whether anything is left is exactly right.
// Source: Cyrus & Beck 1978, Computers & Graphics 3:23; Liang & Barsky 1984, ACM TOG 3:1 (the rectangle); in
// homogeneous coordinates, Blinn & Newell 1978. Departure: they compare rounded quotients.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "nodes/kernels/camera.h"
#include "nodes/kernels/double_double.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

namespace frustum::clip {

// -w <= x, y, z <= w, or with 0 <= z; in the order of kernels::clip_planes.
inline std::vector<glm::dvec4> volume_planes(kernels::ClipSpace space) {
  const auto planes = kernels::clip_planes(space);
  return {planes.begin(), planes.end()};
}

// low.x w <= x <= high.x w, and the same in y, in front of the eye (w >= 0).
inline std::vector<glm::dvec4> rectangle_planes(const glm::dvec2& low, const glm::dvec2& high) {
  return {{1, 0, 0, -low.x}, {-1, 0, 0, high.x}, {0, 1, 0, -low.y}, {0, -1, 0, high.y}, {0, 0, 0, 1}};
}

enum class Role : std::uint8_t { inside, enters, leaves, outside };

// What one plane says to the segment, and the interval that is left after it.
struct Crossing {
  std::size_t plane = 0;
  Role role = Role::inside;
  double d_from = 0, d_to = 0;  // rounded; of the ends scaled by one power of two
  double t = 0;                 // of the crossing; 0 where there is none
  double t_from = 0, t_to = 1;
  bool narrows = false;  // the crossing is the new end of the interval
};

// What is left: from t_from to t_to, and the planes that cut there.
struct Part {
  double t_from = 0, t_to = 1;
  std::optional<std::size_t> from_plane, to_plane;
  glm::dvec4 from{0}, to{0};
};

namespace line_detail {

using Wide = kernels::TwoTerms<double>;

// n . p exactly: at most 8 terms, of which zeros are left out.
struct Distance {
  std::array<double, 8> term{};
  std::size_t terms = 0;
  int sign = 0;
  double largest = 0;  // of the terms
  Wide value{0, 0};    // to 2^-100 of it

  Distance(const glm::dvec4& n, const glm::dvec4& p) {
    for (glm::length_t i = 0; i < 4; ++i) {
      if (n[i] == 0 || p[i] == 0) continue;
      const auto product = kernels::two_product(n[i], p[i]);
      value = kernels::plus(value, product);
      largest = std::max(largest, std::fabs(product.hi));
      term[terms++] = product.hi;
      if (product.lo != 0) term[terms++] = product.lo;
    }
    sign = std::fabs(value.hi) > 0x1p-95 * largest ? (value.hi > 0 ? 1 : -1) : exact_sign();
  }
  double rounded() const { return sign == 0 ? 0 : value.hi; }

 private:
  int exact_sign() const {
    kernels::Expansion<8> sum;
    for (std::size_t i = 0; i < terms; ++i) sum.add(term[i]);
    return sum.sign();
  }
};

struct Pair {
  Distance from, to;
};

// Sign of a.from b.to - b.from a.to: of at most 2 x 8 x 8 products of two terms each.
inline int determinant_sign(const Pair& a, const Pair& b) {
  const auto left = kernels::product(a.from.value, b.to.value),
             right = kernels::product(b.from.value, a.to.value);
  const double det = left.hi - right.hi, size = std::fabs(left.hi) + std::fabs(right.hi);
  // A distance that kept 2^-40 of its terms is right to 2^-60 of itself, far below the filter's 2^-50.
  const auto keeps = [](const Distance& d) {
    return d.sign == 0 || std::fabs(d.value.hi) > 0x1p-40 * d.largest;
  };
  if (std::fabs(det) > 0x1p-50 * size && keeps(a.from) && keeps(a.to) && keeps(b.from) && keeps(b.to))
    return det > 0 ? 1 : -1;
  kernels::Expansion<256> sum;
  const auto add = [&](const Distance& p, const Distance& q, double sign) {
    for (std::size_t i = 0; i < p.terms; ++i)
      for (std::size_t j = 0; j < q.terms; ++j) {
        const auto product = kernels::two_product(p.term[i], sign * q.term[j]);
        sum.add(product.lo), sum.add(product.hi);
      }
  };
  add(a.from, b.to, 1), add(b.from, a.to, -1);
  return sum.sign();
}

inline double parameter(const Pair& d) {
  if (d.from.sign == 0) return 0;
  if (d.to.sign == 0) return 1;
  const Wide length = kernels::plus(d.from.value, {-d.to.value.hi, -d.to.value.lo});
  return std::clamp(kernels::quotient(d.from.value, length).hi, 0.0, 1.0);
}

// The axis of a plane of one axis, with the factor 1 or -1, and w.
inline std::optional<glm::length_t> only_axis(const glm::dvec4& plane) {
  std::optional<glm::length_t> axis;
  for (glm::length_t i = 0; i < 3; ++i) {
    if (plane[i] == 0) continue;
    if (axis || std::fabs(plane[i]) != 1) return std::nullopt;
    axis = i;
  }
  return axis;
}

// Puts a point that rounding left outside such planes, or beside plane k that cut it, onto them.
inline void hold(glm::dvec4& at, std::span<const glm::dvec4> planes, std::size_t k) {
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto axis = only_axis(planes[i]);
    if (!axis) continue;
    const double edge = -planes[i][*axis] * (planes[i].w * at.w);
    if (i == k || (at[*axis] - edge) * planes[i][*axis] < 0) at[*axis] = edge;
  }
}

// A sum of products, rounded once: p + t (q - p) has no digit right where the ends are far larger than it.
class ExactSum {
 public:
  void add(double x, double y) {
    const auto product = kernels::two_product(x, y);
    add(product.lo), add(product.hi);
  }
  double value() const {
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i) sum += term_[i];
    return sum;
  }

 private:
  void add(double term) {
    for (std::size_t i = 0; i < size_; ++i) {
      const auto [sum, error] = kernels::two_sum(term_[i], term);
      term_[i] = error, term = sum;
    }
    if (term != 0) term_[size_++] = term;
  }
  std::array<double, 32> term_{};
  std::size_t size_ = 0;
};

// (d0 q - d1 p) / (d0 - d1), in the box of the two; each coordinate within 2 ulp, whatever the ends. Both ends
// and their distances are those of numbers of about 1.
inline glm::dvec4 point_at(const glm::dvec4& p, const glm::dvec4& q, const Pair& d) {
  const double length = kernels::plus(d.from.value, {-d.to.value.hi, -d.to.value.lo}).hi;
  glm::dvec4 at;
  for (glm::length_t i = 0; i < 4; ++i) {
    ExactSum sum;
    for (std::size_t k = 0; k < d.from.terms; ++k) sum.add(d.from.term[k], q[i]);
    for (std::size_t k = 0; k < d.to.terms; ++k) sum.add(-d.to.term[k], p[i]);
    at[i] = std::clamp(sum.value() / length, std::min(p[i], q[i]), std::max(p[i], q[i]));
  }
  return at;
}

}  // namespace line_detail

// The part of the segment from p to q inside all planes, ends included, and what every plane said to `visit`
// until one left nothing. Nothing where a number is not finite. A segment without length is inside or not. Of
// planes that cut at one t the first counts.
//   t          within 2 ulp, and exactly 0 and 1 where an end lies on the plane
//   from, to   the ends as given where nothing is cut; cut by -w <= x <= w or by x >= c (w = 1) they lie on
//   the plane
//              exactly, so that what was clipped is not clipped again
// Exact while entries, brought to about 1 together, are 0 or above 2^-250. Cost: some 200 operations a plane.
template <class Visit>
std::optional<Part> clip_segment(const glm::dvec4& p, const glm::dvec4& q, std::span<const glm::dvec4> planes,
                                 const Visit& visit) {
  using line_detail::Pair;
  const double largest = std::max(kernels::largest_component(p), kernels::largest_component(q));
  if (!std::isfinite(largest) || !std::isfinite(kernels::largest_component(p + q * 0.0))) return std::nullopt;
  const double scale = largest == 0 ? 1 : kernels::power_of_two_towards_one(largest);
  Part part;
  part.from = p, part.to = q;
  std::optional<Pair> first, last;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const double size = kernels::largest_component(planes[k]);
    const glm::dvec4 n = planes[k] * (size == 0 ? 1 : kernels::power_of_two_towards_one(size));
    const Pair d{{n, p * scale}, {n, q * scale}};
    Crossing c{k, Role::inside, d.from.rounded(), d.to.rounded(), 0, part.t_from, part.t_to, false};
    bool left = true;
    if (d.from.sign < 0 && d.to.sign < 0) {
      c.role = Role::outside, left = false;
    } else if (d.from.sign < 0) {
      c.role = Role::enters, c.t = line_detail::parameter(d);
      c.narrows = !first || line_detail::determinant_sign(*first, d) > 0;
      if (c.narrows) first = d, part.from_plane = k, part.t_from = c.t_from = c.t;
    } else if (d.to.sign < 0) {
      c.role = Role::leaves, c.t = line_detail::parameter(d);
      c.narrows = !last || line_detail::determinant_sign(*last, d) < 0;
      if (c.narrows) last = d, part.to_plane = k, part.t_to = c.t_to = c.t;
    }
    if (first && last && c.narrows) left = line_detail::determinant_sign(*first, *last) <= 0;
    visit(static_cast<const Crossing&>(c));
    if (!left) return std::nullopt;
  }
  const auto cut_at = [&](const Pair& d, std::size_t k) {
    if (d.from.sign == 0) return p;
    if (d.to.sign == 0) return q;
    glm::dvec4 at = line_detail::point_at(p * scale, q * scale, d) / scale;
    line_detail::hold(at, planes, k);
    return at;
  };
  if (first) part.from = cut_at(*first, *part.from_plane);
  if (last) part.to = cut_at(*last, *part.to_plane);
  return part;
}

}  // namespace frustum::clip
