// A ring with a round tube.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/parallel.h"

namespace frustum::mesh {

// `segments` round cross-sections around the y axis, of `sides` vertices each. u runs around the axis from
// +z towards +x, v around the tube from the outer equator upwards. Vertex (i, j), the j-th of the i-th
// section, has the number i sides + j; both ways wrap, so uv belongs to corners.
struct TorusShape {
  double radius, tube;  // of the circle of the tube's centres, and of the tube
  std::uint32_t segments, sides;

  std::size_t vertices() const { return std::size_t{segments} * sides; }
  std::size_t faces() const { return 2 * vertices(); }
  std::uint32_t vertex(std::uint32_t i, std::uint32_t j) const { return i % segments * sides + j % sides; }
};

// Positions and unit normals, each rounded once from double, whose sine and cosine are exact at quarter
// turns. Requires vertices() elements.
template <std::floating_point R>
void torus_vertices(const TorusShape& s, std::span<glm::vec<3, R>> position,
                    std::span<glm::vec<3, R>> normal) {
  std::vector<kernels::SinCos<double>> tube;
  for (std::uint32_t j = 0; j < s.sides; ++j) tube.push_back(kernels::sin_cos_degrees(360.0 * j / s.sides));
  kernels::parallel_blocks(s.segments, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto around = kernels::sin_cos_degrees(360.0 * static_cast<double>(i) / s.segments);
      for (std::size_t j = 0; j < s.sides; ++j) {
        const double out = s.radius + s.tube * tube[j].cos;
        const std::size_t k = i * s.sides + j;
        position[k] = glm::vec<3, R>(out * around.sin, s.tube * tube[j].sin, out * around.cos);
        normal[k] = glm::vec<3, R>(tube[j].cos * around.sin, tube[j].sin, tube[j].cos * around.cos);
      }
    }
  });
}

// Faces 2 k and 2 k + 1 are the halves of quad k, and (u, v) at their corners. Requires faces() and
// 3 faces() elements.
template <std::floating_point R>
void torus_faces(const TorusShape& s, std::span<glm::uvec3> triangle, std::span<glm::vec<2, R>> uv) {
  kernels::parallel_blocks(s.vertices(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t q = begin; q < end; ++q) {
      const auto i = static_cast<std::uint32_t>(q / s.sides), j = static_cast<std::uint32_t>(q % s.sides);
      const std::uint32_t a = s.vertex(i, j), b = s.vertex(i + 1, j), c = s.vertex(i + 1, j + 1),
                          d = s.vertex(i, j + 1);
      triangle[2 * q] = {a, b, c};
      triangle[2 * q + 1] = {a, c, d};
      const auto west = static_cast<R>(static_cast<double>(i) / s.segments),
                 east = static_cast<R>((i + 1.0) / s.segments),
                 low = static_cast<R>(static_cast<double>(j) / s.sides),
                 high = static_cast<R>((j + 1.0) / s.sides);
      uv[6 * q] = uv[6 * q + 3] = {west, low};
      uv[6 * q + 1] = {east, low};
      uv[6 * q + 2] = uv[6 * q + 4] = {east, high};
      uv[6 * q + 5] = {west, high};
    }
  });
}

}  // namespace frustum::mesh
