// The values of one corner for a whole face.
#pragma once

#include <cstddef>
#include <cstring>
#include <glm/vec3.hpp>
#include <span>

#include "nodes/kernels/parallel.h"

namespace frustum::mesh {

/// Rows copies f to copies f + copies - 1 of `to` become the row of `from` at corner `corner` (0 to 2) of face f: row
/// triangle[f][corner] of a column of vertices, row 3 f + corner of one of corners. `row` is the size of one in bytes.
/// Requires rows for all of them. Nothing is computed: the bits are those of the corner. Cost: `copies` copies a face.
inline void take_corner(std::span<const glm::uvec3> triangle, bool of_vertices, int corner,
                        const std::byte* from, std::size_t row, std::size_t copies, std::byte* to) {
  kernels::parallel_blocks(triangle.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      const std::size_t at = of_vertices ? triangle[f][static_cast<glm::length_t>(corner)]
                                         : 3 * f + static_cast<std::size_t>(corner);
      for (std::size_t k = 0; k < copies; ++k) std::memcpy(to + (copies * f + k) * row, from + at * row, row);
    }
  });
}

}  // namespace frustum::mesh
