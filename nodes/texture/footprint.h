// What each pixel sees of a texture, row by row, as numbers to look at.
#pragma once

#include "nodes/kernels/texture_ewa.h"

#include <array>
#include <cstddef>

namespace frustum::texture {

inline constexpr std::array footprint_planes{"major", "minor", "axis.s", "axis.t",
                                             "area",  "ratio", "level",  "ewa_level"};

// Rows of n numbers, in the order of footprint_planes; null where nobody reads them.
template <std::floating_point R>
using FootprintRows = std::array<R*, footprint_planes.size()>;

struct TextureSize {
  int width = 1, height = 1, last_level = 0;
  double max_anisotropy = 16;
};

// The footprint before it is widened; the levels that trilinear and elliptical lookup read. Zeros where
// nothing is seen.
template <std::floating_point R>
void measure_footprints(const TextureSize& size, const kernels::UvRows<R>& in, std::size_t n,
                        const FootprintRows<R>& out) {
  const kernels::TexelLevel base{size.width, size.height, nullptr};
  for (std::size_t x = 0; x < n; ++x) {
    std::array<R, footprint_planes.size()> value{};
    if (in.covers(x)) {
      const auto f = kernels::footprint(in, x, static_cast<R>(size.width), static_cast<R>(size.height));
      const auto axis = f.major_axis();
      const auto widened = kernels::widened(f, static_cast<R>(size.max_anisotropy));
      value = {
          f.major,
          f.minor,
          axis[0],
          axis[1],
          f.area,
          f.minor > R(0) ? f.major / f.minor : R(0),
          kernels::pyramid_level(in.du_dx[x], in.dv_dx[x], in.du_dy[x], in.dv_dy[x], base, size.last_level),
          kernels::ewa_level(widened, size.last_level)};
    }
    for (std::size_t k = 0; k < value.size(); ++k)
      if (out[k] != nullptr) out[k][x] = value[k];
  }
}

}  // namespace frustum::texture
