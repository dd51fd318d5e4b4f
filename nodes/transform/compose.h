// One map of several.
#pragma once

#include <glm/mat4x4.hpp>
#include <span>

#include "nodes/kernels/matrix_product.h"

namespace frustum::transform {

// The map that makes the first map first: ... m[1] m[0]. The identity for none.
inline glm::dmat4 composed(std::span<const glm::dmat4> maps) {
  glm::dmat4 all(1.0);
  for (const glm::dmat4& m : maps) all = kernels::matrix_product(m, all);
  return all;
}

}  // namespace frustum::transform
