#pragma once
// Points, normals and windings under an affine map.

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "nodes/kernels/affine.h"
#include "nodes/kernels/parallel.h"

namespace frustum::kernels {

// to[i] = L from[i] + t in the precision of the buffers, sums in the order x, y, z, t; a mere translation is
// added in double and rounded once. NaN and infinity spread as in any sum. Requires equal sizes.
// Cost: 18 operations a point; memory speed.
template <std::floating_point R>
void map_points(const Affine& map, std::span<const glm::vec<3, R>> from, std::span<glm::vec<3, R>> to) {
  const bool only_moves = map.linear == glm::dmat3(1.0);
  const PointMap<R> point(map);
  parallel_blocks(from.size(), usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      to[i] = only_moves ? glm::vec<3, R>(glm::dvec3(from[i]) + map.translation) : point(from[i]);
  });
}

// Normals by the inverse transpose, made unit again; they stay on the side of the surface they were on. A
// normal without a direction (zero, NaN) comes back as it was. The matrix is first scaled by a power of two,
// so that scales of 1e-30 neither over- nor underflow in float. Requires equal sizes.
template <std::floating_point R>
void map_normals(const Affine& map, std::span<const glm::vec<3, R>> from, std::span<glm::vec<3, R>> to) {
  glm::dmat3 wide = normal_matrix(map);
  double largest = 0;
  for (glm::length_t c = 0; c < 3; ++c) largest = std::max(largest, largest_component(wide[c]));
  wide *= power_of_two_towards_one(largest);
  const glm::mat<3, 3, R> turn(wide);
  parallel_blocks(from.size(), usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& n = from[i];
      to[i] = normalized_or((turn[0] * n.x + turn[1] * n.y) + turn[2] * n.z, n);
    }
  });
}

// The other way round: a mirrored triangle is seen counter-clockwise from its front again once two corners
// change places.
inline glm::uvec3 reversed(const glm::uvec3& triangle) { return {triangle.x, triangle.z, triangle.y}; }

}  // namespace frustum::kernels
