// Triangles of a polygon in space.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

// Appends n - 2 triangles of indices into `corners`, wound like the polygon: kernels::triangulate_polygon
// of the polygon as it is seen along the axis nearest to its Newell normal (one coordinate is dropped and
// none is rounded, so that straight edges stay straight).
//   corners  n >= 3, nearly in a plane, of any size
// True where they tile it without overlap; false where it crosses itself as seen so, has no area (below
// n 2^-50 times the square of its extent even its side is lost in rounding) or is not finite.
bool triangulate(std::span<const glm::dvec3> corners, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace frustum
