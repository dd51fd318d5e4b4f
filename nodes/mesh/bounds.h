// The box of a mesh, and the map that brings it to a standard place.
#pragma once

#include <cmath>
#include <glm/mat4x4.hpp>

#include "nodes/kernels/surface_measures.h"

namespace frustum::mesh {

// Moves the box's middle to the origin and scales all axes alike, so that the longest side runs from -1 to 1.
// A box without extent is only moved. Requires a box that is not empty.
inline glm::dmat4 fitting_matrix(const kernels::Box& box) {
  const double half = kernels::largest_component(box.half_size());
  const double scale = half > 0 && std::isfinite(1 / half) ? 1 / half : 1;
  glm::dmat4 m(scale);
  m[3] = glm::dvec4(-box.centre() * scale, 1);
  return m;
}

}  // namespace frustum::mesh
