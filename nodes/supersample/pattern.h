// A sample pattern for all pixels of a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/sample_pattern.h"

namespace frustum::supersample {

// Fills x and y, [sample][row][column] over period x period pixels, with kernels::fill_sample_offsets.
// Requires x.size() = y.size() = samples * period^2.
inline void fill_pattern(kernels::PatternKind kind, std::uint64_t seed, std::size_t samples,
                         std::size_t period, std::span<std::uint16_t> x, std::span<std::uint16_t> y) {
  const std::size_t pixels = period * period;
  kernels::parallel_blocks(pixels, 256, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint16_t> px(samples), py(samples);
    for (std::size_t i = begin; i < end; ++i) {
      kernels::fill_sample_offsets(kind, seed, static_cast<int>(i % period), static_cast<int>(i / period), px,
                                   py);
      for (std::size_t s = 0; s < samples; ++s) x[s * pixels + i] = px[s], y[s * pixels + i] = py[s];
    }
  });
}

}  // namespace frustum::supersample
