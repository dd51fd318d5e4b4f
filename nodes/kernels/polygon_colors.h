// Colours inside a polygon from those of its corners, three ways.
#pragma once

#include "nodes/kernels/vector.h"

#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>

namespace frustum::kernels {

// Corners in order, either way round, without crossings; a colour each. Nothing is owned.
struct ColoredPolygon {
  std::span<const glm::dvec2> corner;
  std::span<const glm::dvec3> color;
  std::size_t after(std::size_t i) const { return i + 1 < corner.size() ? i + 1 : 0; }
};

// Gouraud's own way: along the two sides that the scan line through p meets next to it, then between them along the line. For four
// corners and more it depends on how the polygon lies on the screen: bilinear, but in the screen's axes.
// Nothing where the line meets no side to the left or right of p, as it does outside of the polygon.
// Source: Gouraud 1971, doi:10.1109/T-C.1971.223313.
inline std::optional<glm::dvec3> scan_line_color(const ColoredPolygon& polygon, const glm::dvec2& p) {
  struct Met {
    double x;
    glm::dvec3 color;
  };
  std::optional<Met> left, right;
  std::size_t before = 0;
  for (std::size_t i = 0; i < polygon.corner.size(); ++i) {
    const std::size_t j = polygon.after(i);
    const glm::dvec2 &a = polygon.corner[i], &b = polygon.corner[j];
    if ((a.y <= p.y) == (b.y <= p.y)) continue;  // half open: a line through a corner meets one of its sides
    const double t = (p.y - a.y) / (b.y - a.y), x = std::lerp(a.x, b.x, t);
    const Met met{x, lerp(polygon.color[i], polygon.color[j], t)};
    if (x <= p.x) {
      ++before;
      if (!left || x > left->x) left = met;
    } else if (!right || x < right->x) {
      right = met;
    }
  }
  if (before % 2 == 0 || !left || !right) return std::nullopt;
  return lerp(left->color, right->color, (p.x - left->x) / (right->x - left->x));
}

// The polygon as triangles (first, i, i + 1), each linear. It does not depend on how the polygon lies, but on which corner is the first:
// another diagonal is another picture. Nothing outside. Right for convex polygons.
inline std::optional<glm::dvec3> fan_color(const ColoredPolygon& polygon, const glm::dvec2& p) {
  const auto area = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return difference_of_products(b.x - a.x, c.y - a.y, c.x - a.x, b.y - a.y);
  };
  for (std::size_t i = 1; i + 1 < polygon.corner.size(); ++i) {
    const glm::dvec2 &a = polygon.corner[0], &b = polygon.corner[i], &c = polygon.corner[i + 1];
    const double all = area(a, b, c);
    if (all == 0) continue;
    const double u = area(a, p, c) / all, v = area(a, b, p) / all;
    if (u < 0 || v < 0 || u + v > 1) continue;
    return polygon.color[0] + (polygon.color[i] - polygon.color[0]) * u +
           (polygon.color[i + 1] - polygon.color[0]) * v;
  }
  return std::nullopt;
}

// Mean value coordinates: neither turning the polygon nor choosing another first corner changes anything but rounding, colours that
// are linear over the plane are met, and so is each side. Defined everywhere, but meant for points inside.
//   weight_i = (tan(a_{i-1} / 2) + tan(a_i / 2)) / r_i, a_i the angle at p between corners i and i + 1, r_i the
//   distance; tan(a / 2) = (r s - d) / A = A / (r s + d) with d the scalar and A the vector product of the two:
//   of both forms the one that adds.
// Source: Hormann & Floater 2006, Mean value coordinates for arbitrary planar polygons, doi:10.1145/1183287.1183295.
// Error: 16 u of the largest colour for convex polygons whose sides are no shorter than 2^-10 of its extent.
inline glm::dvec3 mean_value_color(const ColoredPolygon& polygon, const glm::dvec2& p) {
  glm::dvec3 sum(0);
  double weights = 0;
  const auto half_tangent = [](const glm::dvec2& a, double r, const glm::dvec2& b, double s) {
    const double d = dot(a, b), area = difference_of_products(a.x, b.y, a.y, b.x);
    return d > 0 ? area / (r * s + d) : (r * s - d) / area;
  };
  for (std::size_t i = 0; i < polygon.corner.size(); ++i) {
    const std::size_t j = polygon.after(i);
    const glm::dvec2 a = polygon.corner[i] - p, b = polygon.corner[j] - p;
    const double r = norm(a), s = norm(b);
    if (r == 0) return polygon.color[i];
    if (s == 0) return polygon.color[j];
    const bool opposite = dot(a, b) < 0;
    if (opposite && difference_of_products(a.x, b.y, a.y, b.x) == 0)
      return lerp(polygon.color[i], polygon.color[j], r / (r + s));
    const double t = half_tangent(a, r, b, s);
    sum += polygon.color[i] * (t / r) + polygon.color[j] * (t / s);
    weights += t / r + t / s;
  }
  return sum / weights;
}

}  // namespace frustum::kernels
