// What is known of a texture before it is looked up.
#pragma once

#include "runtime/buffers/texture.h"

#include <array>
#include <optional>

namespace frustum {

// The colour of every texel of every level, where they all have the same bits, finite and without -0: blends
// of it are exactly it. Null where there is a border, and for a checkerboard, whose two colours are blended
// by shares that need not sum to 1 after rounding. Cost: up to the first texel that differs.
std::optional<std::array<float, 4>> constant_color(const Texture&);

// Whether what is looked up may let others show. Means of opaque texels may round to a little less than 1; a cutoff above
// 1 leaves nothing of any.
bool may_be_clear(const Texture&);

// The least alpha of the finest level of at most 2^16 texels: one transparent texel of 2^24 shows in it. 1 for a
// checkerboard, 0 where there is a border.
float least_opacity(const Texture&);

}  // namespace frustum
