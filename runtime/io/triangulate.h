// Triangles of a polygon in space.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

// Appends n - 2 triangles of indices into `corners`, wound like the polygon, and returns true where they
// tile it without overlap: a fan where that is right (every convex polygon), else ears cut one at a time.
//   corners  n >= 3, nearly in a plane; the polygon is seen along its Newell normal
// Where no ear can be found (the outline crosses itself, or has no area), and above 4096 corners that are
// no fan (ears cost n^2), the rest becomes a fan and the result is false.
// Source: Meisters 1975, Polygons have ears.
bool triangulate(std::span<const glm::dvec3> corners, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace frustum
