// The inverse texture map over rows of samples.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>

#include "nodes/kernels/quad_map.h"
#include "nodes/kernels/sample_positions.h"

namespace frustum::texture {

// Rows of n numbers; those that are null are not written.
template <std::floating_point R>
struct UvTargets {
  std::uint32_t* id = nullptr;
  std::array<R*, 6> uv{};  // u v du_dx dv_dx du_dy dv_dy
};

// (u, v) and its slopes at one sample of the pixels (x0, y), (x0 + 1, y) ...: id 0 where the quadrilateral
// owns the sample, `outside` and zeros elsewhere. A pure function of the sample; computed in double, rounded
// once.
template <std::floating_point R>
void unmap_row(const kernels::QuadMap& map, const kernels::SamplePositions& pattern, int sample, int x0,
               int y, std::size_t n, std::uint32_t outside, const UvTargets<R>& out) {
  for (std::size_t i = 0; i < n; ++i) {
    const int x = x0 + static_cast<int>(i);
    const std::size_t at = pattern.index(sample, x, y);
    const glm::dvec2 px(x + pattern.x[at] / double{kernels::sample_unit},
                        y + pattern.y[at] / double{kernels::sample_unit});
    const bool inside = map.contains(px);
    if (out.id != nullptr) out.id[i] = inside ? 0 : outside;
    std::array<double, 6> value{};
    if (inside) {
      const glm::dvec2 uv = map.uv_of(px);
      const kernels::UvSlopes s = map.slopes(px, uv);
      value = {uv.x, uv.y, s.du_dx, s.dv_dx, s.du_dy, s.dv_dy};
    }
    for (std::size_t k = 0; k < 6; ++k)
      if (out.uv[k] != nullptr) out.uv[k][i] = static_cast<R>(value[k]);
  }
}

}  // namespace frustum::texture
