// Vector form of kernels::box_triangles<float>, which is its scalar twin: the same boxes on every SIMD
// target.
#pragma once

#include "nodes/kernels/box_triangles.h"

namespace frustum::kernels::simd {

BoxCounts box_triangles(const ScreenMesh<float>& mesh, std::uint32_t begin, std::uint32_t end,
                        const SampleBox& samples, const PixelRect& window, BoxedTriangle* out);

}  // namespace frustum::kernels::simd
