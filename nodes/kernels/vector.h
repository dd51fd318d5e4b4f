#pragma once
// Vector algebra that holds at the edges: no overflow on the way to a finite result, no silent NaN from a
// vector without a direction. Float functions compute in double and round once.

#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <optional>

#include "nodes/kernels/elementary.h"

namespace frustum::kernels {

// a b - c d: at most 1.5 ulp, where the plain expression may lose every digit.
// Source: Kahan's algorithm; bound: Jeannerod, Louvet & Muller 2013, Math. Comp. 82:2245.
template <std::floating_point R>
R difference_of_products(R a, R b, R c, R d) {
  if constexpr (sizeof(R) == 4) {  // both products are exact in double
    return static_cast<R>(static_cast<double>(a) * b - static_cast<double>(c) * d);
  } else {
    const R cd = c * d;
    const R error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
  }
}

template <std::floating_point R, glm::length_t n>
R dot(const glm::vec<n, R>& a, const glm::vec<n, R>& b) {
  R sum = a[0] * b[0];
  for (glm::length_t i = 1; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

// a x b, each component within 1.5 ulp. Zero for parallel vectors whose products are exact.
template <std::floating_point R>
glm::vec<3, R> cross(const glm::vec<3, R>& a, const glm::vec<3, R>& b) {
  return {difference_of_products(a.y, b.z, a.z, b.y), difference_of_products(a.z, b.x, a.x, b.z),
          difference_of_products(a.x, b.y, a.y, b.x)};
}

// max |v_i|; NaN if any component is NaN.
template <std::floating_point R, glm::length_t n>
R largest_component(const glm::vec<n, R>& v) {
  R largest = 0;
  for (glm::length_t i = 0; i < n; ++i) {
    const R a = std::fabs(v[i]);
    if (!(a <= largest)) largest = a;  // takes NaN in
    if (a != a) return a;
  }
  return largest;
}

// The power of two that brings a finite x > 0 into [1, 2), or as near as the range allows (2^-1022 ...
// 2^1022).
inline double power_of_two_towards_one(double x) {
  const auto exponent = static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff);
  const std::int64_t wanted = 2046 - (exponent < 1 ? 1 : exponent);
  return std::bit_cast<double>(static_cast<std::uint64_t>(wanted < 1 ? 1 : wanted) << 52);
}

namespace vector_detail {
// v as double, multiplied by an exact power of two so that squares neither over- nor underflow.
template <std::floating_point R, glm::length_t n>
struct Scaled {
  glm::vec<n, double> v;
  double scale;
};
template <std::floating_point R, glm::length_t n>
Scaled<R, n> scaled(const glm::vec<n, R>& v, R largest) {
  const glm::vec<n, double> wide(v);
  if constexpr (sizeof(R) == 4) return {wide, 1.0};  // squares of floats lie within 2^-298 ... 2^256
  if (largest > R(0x1p-400) && largest < R(0x1p400)) return {wide, 1.0};
  const double scale = power_of_two_towards_one(static_cast<double>(largest));
  return {wide * scale, scale};
}
}  // namespace vector_detail

// Euclidean length, within 1.5 ulp. Infinite for an infinite component or a length out of range, NaN for NaN.
template <std::floating_point R, glm::length_t n>
R norm(const glm::vec<n, R>& v) {
  const R largest = largest_component(v);
  if (!(largest > 0) || largest == std::numeric_limits<R>::infinity()) return largest;
  const auto s = vector_detail::scaled(v, largest);
  return static_cast<R>(std::sqrt(dot(s.v, s.v)) / s.scale);
}

// The unit vector along v: each component within 1 ulp (float) or 2 ulp (double), for every finite v that
// is not zero, from the smallest subnormal to the largest number. Nothing for zero, infinity and NaN.
// Source: the exact prescale of LAPACK's dnrm2; Blue 1978, TOMS 4:15.
template <std::floating_point R, glm::length_t n>
std::optional<glm::vec<n, R>> normalized(const glm::vec<n, R>& v) {
  const R largest = largest_component(v);
  if (!(largest > 0) || largest == std::numeric_limits<R>::infinity()) return std::nullopt;
  const auto s = vector_detail::scaled(v, largest);
  return glm::vec<n, R>(s.v / std::sqrt(dot(s.v, s.v)));
}

// The same, with a fallback where there is no direction.
template <std::floating_point R, glm::length_t n>
glm::vec<n, R> normalized_or(const glm::vec<n, R>& v, const glm::vec<n, R>& fallback) {
  return normalized(v).value_or(fallback);
}

// Angle between two vectors in [0, pi], within 4 ulp however small or near pi; 0 if either is zero.
// Source: Kahan 2006, "How futile are mindless assessments of roundoff", section 12: acos(a.b) has no
// correct digit near 0 and pi, atan2(|a x b|, a.b) keeps them all.
template <std::floating_point R>
R angle_between(const glm::vec<3, R>& a, const glm::vec<3, R>& b) {
  const R la = largest_component(a), lb = largest_component(b);
  if (la == 0 || lb == 0) return la == 0 ? lb * 0 : la * 0;
  const auto wide = [](const glm::vec<3, R>& v, R largest) {
    return glm::dvec3(v) * power_of_two_towards_one(static_cast<double>(largest));
  };
  const glm::dvec3 p = wide(a, la), q = wide(b, lb);
  return static_cast<R>(atan2(norm(cross(p, q)), dot(p, q)));
}

// The mirror image of l about the unit normal n; l points away from the surface, and so does the result.
// 2 n (n.l) - l: errata E34 and E46.
template <std::floating_point R, glm::length_t n>
glm::vec<n, R> reflected(const glm::vec<n, R>& l, const glm::vec<n, R>& normal) {
  return normal * (2 * dot(normal, l)) - l;
}

// a at t = 0 and b at t = 1 exactly, monotonic between, and a where a = b. Source: C++20 std::lerp, P0811.
template <std::floating_point R, glm::length_t n>
glm::vec<n, R> lerp(const glm::vec<n, R>& a, const glm::vec<n, R>& b, R t) {
  glm::vec<n, R> p;
  for (glm::length_t i = 0; i < n; ++i) p[i] = std::lerp(a[i], b[i], t);
  return p;
}

// Two unit vectors that complete the unit vector n to a right-handed frame (tangent, bitangent, n),
// orthonormal to 6 u everywhere (of which 2 u are what n itself may be off). Continuous except across n.z =
// 0. Source: Duff et al. 2017, "Building an orthonormal basis, revisited", JCGT 6(1).
template <std::floating_point R>
struct Frame3 {
  glm::vec<3, R> tangent, bitangent;
};
template <std::floating_point R>
Frame3<R> orthonormal_frame(const glm::vec<3, R>& n) {
  const R sign = std::copysign(R(1), n.z);
  const R a = -1 / (sign + n.z);
  const R b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

}  // namespace frustum::kernels
