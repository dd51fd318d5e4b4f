// Attributes at the samples where a face is seen.
#pragma once

#include "nodes/kernels/interpolate_attributes.h"
#include "nodes/kernels/simd/interpolate_attributes.h"

namespace frustum {

// See kernels::interpolate_attributes: with vectors for single precision, the same bytes on every target.
template <std::floating_point R>
void attributes_at(const kernels::AttributeScene<R>& scene, kernels::PixelRect rect,
                   kernels::PlaneView<const std::uint32_t> id, const kernels::AttributePlanes<R>& planes) {
  if constexpr (std::is_same_v<R, float>)
    kernels::simd::interpolate_attributes(scene, rect, id, planes);
  else
    kernels::interpolate_attributes(scene, rect, id, planes);
}

}  // namespace frustum
