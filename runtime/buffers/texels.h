// A texture as the kernels look it up.
#pragma once

#include "nodes/kernels/texture_lookup.h"
#include "runtime/buffers/texture.h"

#include <array>
#include <vector>

namespace frustum {

// The levels of a pyramid, which must outlive them; none for a checkerboard. Throws NodeError("empty_texture") at the
// input 'texture' where there is no level, no texel, or more than 32 levels.
std::vector<kernels::TexelLevel> texel_levels(const Texture&);

template <class R>
kernels::CheckerColors<R> checker_colors(const Checker& c) {
  const auto narrow = [](const glm::dvec3& v) {
    return std::array{static_cast<R>(v.r), static_cast<R>(v.g), static_cast<R>(v.b)};
  };
  return {static_cast<R>(c.scale), narrow(c.even), narrow(c.odd)};
}

}  // namespace frustum
