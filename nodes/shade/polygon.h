// A polygon on the screen, turned about its middle, with another corner first.
#pragma once

#include "nodes/kernels/polygon_colors.h"

#include <vector>

namespace frustum::polygon_shading {

struct Polygon {
  std::vector<glm::dvec2> corner;  ///< pixels, y down
  std::vector<glm::dvec3> color;
  kernels::ColoredPolygon view() const { return {corner, color}; }
};

/// Turned by an angle (radians, from x to y) about the mean of its corners, which stays: a quarter turn is exact but for the
/// rounding of that middle. Corner `first` becomes the first.
inline Polygon turned(const Polygon& p, double angle, std::size_t first) {
  const std::size_t n = p.corner.size();
  glm::dvec2 middle(0);
  for (const glm::dvec2& c : p.corner) middle += c / static_cast<double>(n);
  const double c = kernels::cos(angle), s = kernels::sin(angle);
  Polygon to;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = (first + i) % n;
    const glm::dvec2 d = p.corner[k] - middle;
    to.corner.push_back(middle + glm::dvec2(c * d.x - s * d.y, s * d.x + c * d.y));
    to.color.push_back(p.color[k]);
  }
  return to;
}

}  // namespace frustum::polygon_shading
