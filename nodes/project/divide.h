// Clip space to NDC.
#pragma once

#include <atomic>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>

#include "nodes/kernels/camera.h"
#include "nodes/kernels/parallel.h"

namespace frustum::project {

// p_ndc[i] = (x / w, y / w, z / w), each rounded once, where w > 0 and all three are finite; elsewhere (0, 0,
// 0) with no_point[i] = 1: the point is on or behind the eye's plane, or was not finite. Returns how many of
// those there are. Without `divides`, which requires w = 1 everywhere, nothing is divided and the bits are the
// same. Requires equal sizes. Cost: 3 divisions a point.
template <std::floating_point R>
std::size_t clip_to_ndc(bool divides, std::span<const glm::vec<4, R>> p_clip, std::span<glm::vec<3, R>> p_ndc,
                        std::span<std::uint8_t> no_point) {
  std::atomic<std::size_t> without{0};
  kernels::parallel_blocks(p_clip.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec<3, R> p = divides ? kernels::divided(p_clip[i]) : glm::vec<3, R>(p_clip[i]);
      const bool good = p_clip[i].w > 0 && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      p_ndc[i] = good ? p : glm::vec<3, R>(0);
      no_point[i] = good ? 0 : 1;
      here += good ? 0 : 1;
    }
    if (here > 0) without += here;
  });
  return without;
}

}  // namespace frustum::project
