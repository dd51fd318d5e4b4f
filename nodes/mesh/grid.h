// A rectangle of triangles in the plane y = 0, its front upwards.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "nodes/kernels/parallel.h"

namespace frustum::mesh {

// columns x rows quads, each cut into two triangles; u runs along +x, v along -z (up, seen from above with -z
// on top), from 0 to `repeat`, and the middle is the origin. Vertex (i, j) has the number j (columns + 1) + i.
struct GridShape {
  glm::dvec2 size;  // along x and z
  std::uint32_t columns, rows;
  glm::dvec2 repeat{1};

  std::size_t vertices() const { return (std::size_t{columns} + 1) * (std::size_t{rows} + 1); }
  std::size_t faces() const { return 2 * std::size_t{columns} * rows; }
};

// Positions and texture coordinates, each rounded once; the borders lie at exactly half the size. Requires
// vertices() elements.
template <std::floating_point R>
void grid_vertices(const GridShape& s, std::span<glm::vec<3, R>> position, std::span<glm::vec<2, R>> uv) {
  const std::size_t width = std::size_t{s.columns} + 1;
  kernels::parallel_blocks(s.vertices(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const double u = static_cast<double>(k % width) / s.columns,
                   v = static_cast<double>(k / width) / s.rows;
      position[k] = glm::vec<3, R>(s.size.x * (u - 0.5), 0.0, s.size.y * (0.5 - v));
      uv[k] = glm::vec<2, R>(u * s.repeat.x, v * s.repeat.y);
    }
  });
}

// Faces 2 k and 2 k + 1 are the halves of quad k, which share its diagonal from (0, 0) to (1, 1). Requires
// faces() elements.
inline void grid_faces(const GridShape& s, std::span<glm::uvec3> triangle) {
  const std::size_t width = std::size_t{s.columns} + 1;
  kernels::parallel_blocks(s.faces() / 2, kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const auto a = static_cast<std::uint32_t>(q / s.columns * width + q % s.columns);
      const auto d = static_cast<std::uint32_t>(a + width);
      triangle[2 * q] = {a, a + 1, d + 1};
      triangle[2 * q + 1] = {a, d + 1, d};
    }
  });
}

}  // namespace frustum::mesh
