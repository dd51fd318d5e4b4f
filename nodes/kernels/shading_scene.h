// What faces look like and what lights them: all of shading that does not depend on a pixel.
#pragma once

#include "nodes/kernels/lighting.h"

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <vector>

namespace frustum::kernels {

template <std::floating_point R>
struct ShadedSurface {
  SurfaceColors<R> colors;
  Highlight highlight = Highlight::none;
  Exponent<R> exponent;
  bool two_sided = false;
};

template <std::floating_point R>
struct ShadingScene {
  std::vector<LightSource<R>> lights;
  Triple<R> eye{};
  std::vector<ShadedSurface<R>> surfaces;  ///< at least one
  std::vector<std::uint32_t> surface_of;   ///< by face; empty: all have the first
  std::vector<R> side;                     ///< by face +1, or -1 where the eye sees its back; empty: all +1
  std::vector<R> opacity;                  ///< by face, in [0, 1]; empty: all 1
  bool highlights = false;                 ///< some surface has one

  LightSetup<R> setup(const ShadedSurface<R>& s) const { return {lights, eye, s.highlight, s.exponent}; }
  const ShadedSurface<R>& surface(std::size_t face) const {
    return surfaces[surface_of.empty() ? 0 : surface_of[face]];
  }
  /// Whether the light that reaches a point depends on where it is.
  bool needs_positions() const {
    return highlights || std::any_of(lights.begin(), lights.end(), [](const auto& l) { return l.is_point; });
  }
  R side_of(std::size_t face) const { return side.empty() ? R(1) : side[face]; }
};

}  // namespace frustum::kernels
