// Three ways to draw what is seen: blocks, wires, shades.
#pragma once

#include "nodes/kernels/vector.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace frustum::style {

/// Distance in pixels from points of the screen to the nearest side of a triangle, measured from inside. A triangle without
/// area is nothing but side.
class SideDistance {
 public:
  SideDistance(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c)
      : corner_{a, b, c}, along_{direction(a, b), direction(b, c), direction(c, a)} {}
  double at(const glm::dvec2& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
      const glm::dvec2 q = p - corner_[i];
      least = std::min(least, std::fabs(along_[i].x * q.y - along_[i].y * q.x));
    }
    return least;
  }

 private:
  static glm::dvec2 direction(const glm::dvec2& from, const glm::dvec2& to) {
    return kernels::normalized_or(to - from, glm::dvec2(0));
  }
  std::array<glm::dvec2, 3> corner_, along_;
};

}  // namespace frustum::style
