// Smooth surfaces before they are triangles: tensor-product Bezier patches over shared control points.
#pragma once

#include "runtime/core/buffer.h"
#include "runtime/core/space.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace frustum {

// Bicubic patches. Patch p has control point control[p][4 i + j] for row i (u) and column j (v).
// Patches that share boundary control points (by index) share that boundary exactly.
// The front of a patch is the side that dP/du x dP/dv points to.
struct Surface {
  std::vector<glm::dvec3> points;
  std::vector<std::array<std::uint32_t, 16>> patches;
  Space space = Space::object;
};

template <>
const BufferType& buffer_type<Surface>();

}  // namespace frustum
