// Vector form of kernels::interpolate_attributes<float>, which is its scalar twin: the same bytes on every
// SIMD target.
#pragma once

#include "nodes/kernels/interpolate_attributes.h"

namespace frustum::kernels::simd {

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes);

}  // namespace frustum::kernels::simd
