// Which faces lie wholly outside one side of the view volume.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/clip.h"
#include "nodes/kernels/parallel.h"

namespace frustum::cull {

// Faces that may show: those that no side of the volume has wholly outside it. Conservative and, in clip
// space, exact: a distance such as w - x is one rounding, which keeps its sign, so no face that touches the
// volume is lost. A NaN coordinate counts as outside both of its sides. Cost: one pass over the vertices, one
// over the faces.
template <std::floating_point R>
std::vector<std::uint32_t> faces_not_outside(kernels::ClipSpace space,
                                             std::span<const glm::vec<4, R>> position,
                                             std::span<const glm::uvec3> triangle) {
  std::vector<std::uint8_t> code(position.size());
  kernels::parallel_blocks(position.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) code[i] = kernels::volume_outcode(space, R(1), position[i]);
  });
  return kernels::indices_where(triangle.size(), [&](std::size_t f) {
    const auto& t = triangle[f];
    return (code[t.x] & code[t.y] & code[t.z]) == 0;
  });
}

}  // namespace frustum::cull
