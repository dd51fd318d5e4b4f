// Lame's curves |x / a|^n + |y / b|^n = 1 by both of their forms (errata E59: the exponent is 2 / n - 1,
// and y has b).
#pragma once

#include <cmath>
#include <concepts>
#include <glm/vec2.hpp>

#include "nodes/kernels/elementary.h"

namespace frustum::supercircle {

// a cos t |cos t|^(2 / n - 1) and b sin t |sin t|^(2 / n - 1), written sign(c) |c|^(2 / n), so that 0 to a
// power below 0 never arises. Points on the axes are exact. Source: Gardner 1965, "The superellipse",
// Scientific American 213(3):222.
template <std::floating_point R>
glm::vec<2, R> by_parameter(const glm::vec<2, R>& radii, R n, R degrees) {
  const auto [sine, cosine] = kernels::sin_cos_degrees(degrees);
  const auto power = [&](R x) { return x == 0 ? x : std::copysign(kernels::pow(std::fabs(x), R(2) / n), x); };
  return {radii.x * power(cosine), radii.y * power(sine)};
}

// Where the ray at an angle meets the implicit form: with u = |cos / a|, v = |sin / b| and m the larger of
// both the distance is 1 / (m (1 + (min / m)^n)^(1 / n)), in which nothing overflows at any n.
template <std::floating_point R>
glm::vec<2, R> by_ray(const glm::vec<2, R>& radii, R n, R degrees) {
  const auto [sine, cosine] = kernels::sin_cos_degrees(degrees);
  const R u = std::fabs(cosine) / radii.x, v = std::fabs(sine) / radii.y;
  const R most = u > v ? u : v, least = u > v ? v : u;
  const R ratio = least == 0 ? R(0) : kernels::pow(least / most, n);
  const R distance = 1 / (most * kernels::pow(1 + ratio, 1 / n));
  return {cosine * distance, sine * distance};
}

// |x / a|^n + |y / b|^n - 1: what is left of the implicit form. An ulp of x shows n times.
inline double residual(const glm::dvec2& radii, double n, const glm::dvec2& p) {
  const auto power = [&](double x) { return x == 0 ? 0.0 : kernels::pow(std::fabs(x), n); };
  return (power(p.x / radii.x) - 1) + power(p.y / radii.y);
}

}  // namespace frustum::supercircle
