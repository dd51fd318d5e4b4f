// World space to eye space.
#pragma once

#include <concepts>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "nodes/kernels/affine.h"
#include "nodes/kernels/parallel.h"

namespace frustum::project {

// p_eye[i] = R (p_world[i] - eye) in the precision of the buffers. Subtracting first keeps the digits of
// points near a camera far from the origin: the rounding of the eye moves all points alike, while R p - R eye
// would round each by u |eye|. NaN and infinity give NaN. Requires equal sizes. Cost: 15 operations a point;
// memory speed.
template <std::floating_point R>
void world_to_eye(const kernels::Affine& eye_from_world, std::span<const glm::vec<3, R>> p_world,
                  std::span<glm::vec<3, R>> p_eye) {
  const glm::mat<3, 3, R> turn(eye_from_world.linear);
  const glm::vec<3, R> eye(eye_from_world.inverse_translation);
  kernels::parallel_blocks(p_world.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec<3, R> d = p_world[i] - eye;
      p_eye[i] = (turn[0] * d.x + turn[1] * d.y) + turn[2] * d.z;
    }
  });
}

}  // namespace frustum::project
