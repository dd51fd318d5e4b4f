// Clip space to pixels: the divide by w and the viewport map in one pass.
#pragma once

#include <atomic>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>

#include "nodes/kernels/camera.h"
#include "nodes/kernels/parallel.h"

namespace frustum::project {

// p_screen[i] = (x_px, y_px, z, 1/w) with x_px = (x/w + 1) W/2 and y_px = (1 - y/w) H/2, y down (errata E10), or
// (1 + y/w) H/2 where y of clip space points down already,
// where w > 0 and all four are finite; elsewhere zeros with no_point[i] = 1: the point is on or behind the
// eye's plane, or was not finite. Returns how many of those there are. Quotients are rounded to R first, so
// that the pixels are those of the NDC that project.divide shows. Without `divides`, which requires w = 1
// everywhere, nothing is divided and the bits are the same. Requires equal sizes. 4 divisions.
template <std::floating_point R>
std::size_t clip_to_screen(bool divides, const kernels::Viewport& viewport,
                           std::span<const glm::vec<4, R>> p_clip, std::span<glm::vec<4, R>> p_screen,
                           std::span<std::uint8_t> no_point) {
  std::atomic<std::size_t> without{0};
  kernels::parallel_blocks(p_clip.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    std::size_t here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec<3, R> ndc = divides ? kernels::divided(p_clip[i]) : glm::vec<3, R>(p_clip[i]);
      const glm::vec<4, R> p(viewport.x_px(ndc.x), viewport.y_px(ndc.y), ndc.z,
                             divides ? 1 / p_clip[i].w : R(1));
      const bool good = p_clip[i].w > 0 && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
                        std::isfinite(p.w);
      p_screen[i] = good ? p : glm::vec<4, R>(0);
      no_point[i] = good ? 0 : 1;
      here += good ? 0 : 1;
    }
    if (here > 0) without += here;
  });
  return without;
}

}  // namespace frustum::project
