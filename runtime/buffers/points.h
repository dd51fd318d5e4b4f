// Points and vectors as kinds of their own, so that a link that takes one for the other is an error of the graph:
// a point has w = 1 and moves with the origin, a vector has w = 0 and does not.
#pragma once

#include "runtime/core/buffer.h"

#include <glm/vec3.hpp>

#include <vector>

namespace frustum {

struct Points {
  std::vector<glm::dvec3> at;
};

struct Vectors {
  std::vector<glm::dvec3> along;
};

template <>
const BufferType& buffer_type<Points>();
template <>
const BufferType& buffer_type<Vectors>();

}  // namespace frustum
