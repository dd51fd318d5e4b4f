// Vector form of kernels::fill_triangles<float>, which is its scalar twin: the same bytes on every SIMD
// target.
#pragma once

#include "nodes/kernels/fill_triangles.h"

namespace frustum::kernels::simd {

void fill_triangles(const FillScene<float>& scene, PixelRect rect, PlaneView<std::uint32_t> id,
                    PlaneView<float> z);

}  // namespace frustum::kernels::simd
