// Which side of each face the camera sees.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/simd/facing.h"

namespace frustum::cull {

// Three numbers (x, y, w) for each corner whose determinant has the sign of the face's area on the screen, y
// up: 1 where its front (counter-clockwise) faces the camera, -1 where its back does, 0 edge-on. The sign is
// exact for the numbers given, so the two faces of a silhouette edge never disagree about it (hard case
// CLP-10).
//
//   eye space, perspective    (x, y, -z): the determinant is the volume of eye, a, b, c: the
//                             plane test of the notes, P(eye) > 0, without a rounded plane (errata E24)
//   eye space, orthographic   (x, y, 1): the sign of n_z (errata E23)
//   clip space                (x, y, w): right for corners on either side of the eye, and before any divide
//   NDC                       (x, y, 1); both with the other sign where their y points down
//   screen                    (x, -y, 1): its y points down
// NaN and infinite corners make 0.
enum class Rows : std::uint8_t { eye_perspective, flat, clip, screen };

template <Rows rows, class Point>
auto corner_row(const Point& p) {
  using R = typename Point::value_type;
  if constexpr (rows == Rows::eye_perspective)
    return glm::vec<3, R>(p.x, p.y, -p.z);
  else if constexpr (rows == Rows::clip)
    return glm::vec<3, R>(p.x, p.y, p.w);
  else if constexpr (rows == Rows::screen)
    return glm::vec<3, R>(p.x, -p.y, 1);
  else
    return glm::vec<3, R>(p.x, p.y, 1);
}

// The same rows for the vector kernel, which takes y up and the third number as it lies: true where that
// turns the sign.
template <Rows rows>
constexpr bool turns_sign = rows == Rows::eye_perspective || rows == Rows::screen;

// Faces whose side is `wanted` (1 front, -1 back), ascending. Edge-on faces are never among them.
// Cost: in float some 3 ns a face, where rounding decides or in double some 15 ns.
template <Rows rows, class Point>
std::vector<std::uint32_t> faces_showing(int wanted, std::span<const Point> position,
                                         std::span<const glm::uvec3> triangle) {
  using R = typename Point::value_type;
  constexpr auto stride = static_cast<std::size_t>(Point::length());
  const auto exact = [&](std::size_t f) {
    const auto& t = triangle[f];
    return kernels::determinant_sign(corner_row<rows>(position[t.x]), corner_row<rows>(position[t.y]),
                                     corner_row<rows>(position[t.z]));
  };
  if constexpr (sizeof(R) == 8) {
    return kernels::indices_where(triangle.size(), [&](std::size_t f) { return exact(f) == wanted; });
  } else {
    constexpr int third = rows == Rows::clip ? 3 : (rows == Rows::eye_perspective ? 2 : -1);
    const kernels::simd::RowLayout layout{reinterpret_cast<const R*>(position.data()), position.size(),
                                          stride, third};
    const int clear_wanted = turns_sign<rows> ? -wanted : wanted;
    return kernels::indices_marked(triangle.size(), [&](std::size_t begin, std::size_t end,
                                                        std::uint8_t* flags) {
      const auto sign = std::make_unique_for_overwrite<std::int8_t[]>(end - begin);
      const std::span block(sign.get(), end - begin);
      kernels::simd::clear_signs(layout, triangle.subspan(begin, end - begin), block);
      for (std::size_t i = 0; i < block.size(); ++i)
        flags[i] =
            (sign[i] == kernels::simd::unclear_sign ? exact(begin + i) == wanted : sign[i] == clear_wanted)
                ? 1
                : 0;
    });
  }
}

}  // namespace frustum::cull
