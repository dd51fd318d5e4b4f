// Where in a pixel its samples lie.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "nodes/kernels/screen_triangle.h"

namespace frustum::kernels {

// Offsets of the samples inside a pixel in 2^-12 px, [0, 4096), indexed [sample][y mod period][x mod period].
// Nothing is owned. The period is a power of two; 1 is the same pattern in every pixel.
struct SamplePositions {
  int samples = 1, period = 1;
  std::span<const std::uint16_t> x, y;

  std::size_t index(int sample, int px, int py) const {
    const int u = px & (period - 1), v = py & (period - 1);  // right for negative pixels, too
    return static_cast<std::size_t>((sample * period + v) * period + u);
  }
};

// One sample in the middle of the pixel.
inline SamplePositions centre_sample() {
  static constexpr std::array<std::uint16_t, 1> half{sample_unit / 2};
  return {1, 1, half, half};
}

// The least box that holds all samples of a pixel, in 2^-12 px, both ends included.
struct SampleBox {
  int x0, y0, x1, y1;
};
inline SampleBox sample_box(const SamplePositions& pattern) {
  const auto [x0, x1] = std::minmax_element(pattern.x.begin(), pattern.x.end());
  const auto [y0, y1] = std::minmax_element(pattern.y.begin(), pattern.y.end());
  return {*x0, *y0, *x1, *y1};
}

}  // namespace frustum::kernels
