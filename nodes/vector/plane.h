// The plane of a polygon by Newell's sum, and the sides and distances of points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <span>

#include "nodes/kernels/predicates.h"
#include "nodes/kernels/sum.h"
#include "nodes/kernels/vector.h"

namespace frustum::vector {

struct Plane {
  glm::dvec3 normal;                  // unit length; the corners turn counter-clockwise seen against it
  glm::dvec3 middle;                  // of the corners: a point of the plane
  double area, residual, condition;   // residual: the farthest corner; condition: perimeter^2 / area
  std::array<glm::dvec3, 3> corners;  // three of the polygon's that span it best, in its sense

  double d() const { return -kernels::dot(normal, middle); }
  // a x + b y + c z + d, from the middle: error a few u |p - middle|, wherever the plane lies.
  double distance(const glm::dvec3& p) const { return kernels::dot(normal, p - middle); }
  // 1 in front (where the normal points), -1 behind, 0 in the plane of the three corners; exact.
  int side(const glm::dvec3& p) const { return -kernels::orientation(corners[0], corners[1], corners[2], p); }
};

namespace plane_detail {

// sum p_i x p_(i+1) about a corner, each component with compensated sums of products within 1.5 ulp.
inline glm::dvec3 newell(std::span<const glm::dvec3> p) {
  std::array<kernels::CompensatedSum<double>, 3> sum;
  for (std::size_t i = 1; i + 1 < p.size(); ++i) {
    const glm::dvec3 c = kernels::cross(p[i] - p[0], p[i + 1] - p[0]);
    for (glm::length_t axis = 0; axis < 3; ++axis) sum[static_cast<std::size_t>(axis)].add(c[axis]);
  }
  return {sum[0].value(), sum[1].value(), sum[2].value()};
}

// The corner farthest from p0, and the one whose triangle with both is the largest along the normal.
inline std::array<glm::dvec3, 3> widest(std::span<const glm::dvec3> p, const glm::dvec3& normal) {
  const auto length2 = [](const glm::dvec3& v) { return kernels::dot(v, v); };
  const glm::dvec3 b = *std::max_element(p.begin(), p.end(), [&](const glm::dvec3& s, const glm::dvec3& t) {
    return length2(s - p[0]) < length2(t - p[0]);
  });
  const auto area = [&](const glm::dvec3& c) {
    return kernels::dot(kernels::cross(b - p[0], c - p[0]), normal);
  };
  const glm::dvec3 c = *std::max_element(p.begin(), p.end(), [&](const glm::dvec3& s, const glm::dvec3& t) {
    return std::fabs(area(s)) < std::fabs(area(t));
  });
  if (area(c) < 0) return {p[0], c, b};
  return {p[0], b, c};
}

}  // namespace plane_detail

// The plane of three or more corners, or nothing where they do not span one: where the area is below 16 u times the
// squared perimeter, Newell's sum is made of rounding. Angle error of the normal: 8 u condition.
// Source: Newell's method in Sutherland, Sproull & Schumacker 1974, Computing Surveys 6:1; Tampieri 1992,
// Graphics Gems III, p. 231 (here about a corner, so that the place does not matter, and compensated).
inline std::optional<Plane> plane_of(std::span<const glm::dvec3> p) {
  if (p.size() < 3) return std::nullopt;
  const glm::dvec3 sum = plane_detail::newell(p);
  double perimeter = 0;
  glm::dvec3 middle(0);
  for (std::size_t i = 0; i < p.size(); ++i) {
    perimeter += kernels::norm(p[i + 1 == p.size() ? 0 : i + 1] - p[i]);
    middle += (p[i] - p[0]) / static_cast<double>(p.size());
  }
  Plane out{};
  out.area = kernels::norm(sum) / 2;
  const auto normal = kernels::normalized(sum);
  if (!normal || !(out.area > 16 * 0x1p-53 * perimeter * perimeter)) return std::nullopt;
  out.normal = *normal;
  out.middle = p[0] + middle;
  out.condition = perimeter * (perimeter / out.area);
  for (const glm::dvec3& q : p) out.residual = std::max(out.residual, std::fabs(out.distance(q)));
  out.corners = plane_detail::widest(p, *normal);
  return out;
}

}  // namespace frustum::vector
