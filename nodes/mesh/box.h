// A box with sharp edges and shared corners.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

namespace frustum::mesh {

inline constexpr std::size_t box_vertices = 8, box_faces = 12;

// Vertex k lies at +x, +y, +z where bits 0, 1, 2 of k are set.
template <std::floating_point R>
void box_positions(const glm::dvec3& size, std::span<glm::vec<3, R>> position) {
  for (std::size_t k = 0; k < box_vertices; ++k)
    position[k] = glm::vec<3, R>(size.x * ((k & 1) != 0 ? 0.5 : -0.5), size.y * ((k & 2) != 0 ? 0.5 : -0.5),
                                 size.z * ((k & 4) != 0 ? 0.5 : -0.5));
}

// Sides in the order +x -x +y -y +z -z, two triangles each: 0 1 2 and 0 2 3 of the side's corners, which run
// counter-clockwise seen from outside, from the one with (u, v) = (0, 0). The side walls have v upwards.
inline constexpr std::array<std::array<std::uint32_t, 4>, 6> box_sides{
    {{5, 1, 3, 7}, {0, 4, 6, 2}, {6, 7, 3, 2}, {0, 1, 5, 4}, {4, 5, 7, 6}, {1, 0, 2, 3}}};

// Triangles, and at each corner the side's normal and its own (u, v) square. Requires 12 and twice 36
// elements.
template <std::floating_point R>
void box_corners(std::span<glm::uvec3> triangle, std::span<glm::vec<3, R>> normal,
                 std::span<glm::vec<2, R>> uv) {
  constexpr std::array<std::array<std::size_t, 3>, 2> halves{{{0, 1, 2}, {0, 2, 3}}};
  const std::array<glm::vec<2, R>, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  for (std::size_t f = 0; f < box_faces; ++f) {
    const std::size_t side = f / 2;
    glm::vec<3, R> n(0);
    n[static_cast<glm::length_t>(side / 2)] = side % 2 == 0 ? R(1) : R(-1);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t k = halves[f % 2][c];
      triangle[f][static_cast<glm::length_t>(c)] = box_sides[side][k];
      normal[3 * f + c] = n;
      uv[3 * f + c] = square[k];
    }
  }
}

}  // namespace frustum::mesh
