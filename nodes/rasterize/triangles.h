// The nearest face at every sample: triangles are binned once, then any rectangle can be filled.
#pragma once

#include "nodes/kernels/fill_triangles.h"
#include "nodes/kernels/simd/fill_triangles.h"

namespace frustum {

// Keeps the spans it is given; their owner outlives it. Filling is const: many threads may fill at once.
template <std::floating_point R>
class TriangleRasterizer {
 public:
  TriangleRasterizer(const kernels::ScreenMesh<R>& mesh, const kernels::SamplePositions& pattern,
                     kernels::PixelRect window, kernels::DepthOrder order,
                     const std::function<void(std::uint64_t)>& claim = {})
      : mesh_(mesh),
        pattern_(pattern),
        order_(order),
        bins_(kernels::bin_triangles(mesh, pattern, window, claim)) {}

  const kernels::TriangleBins& bins() const { return bins_; }

  // See kernels::fill_triangles; the same bytes for any rectangles.
  void fill(kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id, kernels::PlaneView<R> z) const {
    const kernels::FillScene<R> scene{mesh_, pattern_, &bins_, order_};
    if constexpr (std::is_same_v<R, float>)
      kernels::simd::fill_triangles(scene, rect, id, z);
    else
      kernels::fill_triangles(scene, rect, id, z);
  }

 private:
  kernels::ScreenMesh<R> mesh_;
  kernels::SamplePositions pattern_;
  kernels::DepthOrder order_;
  kernels::TriangleBins bins_;
};

}  // namespace frustum
