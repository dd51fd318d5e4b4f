// How many levels a pyramid of images has; how they are made is nodes/kernels/image_pyramid.h.
#pragma once

#include <algorithm>
#include <bit>

namespace frustum {

// Both sides halve, rounding down, until both are 1: 1 + floor(log2(larger side)). Requires sides >= 1.
constexpr int pyramid_levels(int width, int height) {
  return static_cast<int>(std::bit_width(static_cast<unsigned>(std::max(width, height))));
}

}  // namespace frustum
