// Where copies of a mesh stand.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "nodes/kernels/affine.h"

namespace frustum::mesh {

// First stretched, then turned counter-clockwise about an axis, then moved. Nothing where a factor is zero,
// the axis has no direction, or a number is not finite.
inline std::optional<kernels::Affine> placement(const glm::dvec3& scale, const glm::dvec3& axis,
                                                double degrees, const glm::dvec3& translate) {
  const auto stretch = kernels::scaling(scale);
  const auto turn = kernels::rotation(axis, degrees);
  if (!stretch || !turn || !std::isfinite(kernels::largest_component(translate))) return std::nullopt;
  return kernels::composed(kernels::translation(translate), kernels::composed(*turn, *stretch));
}

// Every map once at every point, points outermost: maps[m] then a translation by points[p] is number
// p maps.size() + m. Without points, the maps themselves.
inline std::vector<kernels::Affine> spread(std::span<const kernels::Affine> maps,
                                           const std::vector<glm::dvec3>& points) {
  std::vector<kernels::Affine> all;
  all.reserve(maps.size() * points.size());
  for (const glm::dvec3& p : points)
    for (const kernels::Affine& map : maps) all.push_back(kernels::composed(kernels::translation(p), map));
  return all;
}

}  // namespace frustum::mesh
