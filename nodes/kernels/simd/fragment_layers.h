// Vector form of kernels::fill_fragments<float> and count_fragments<float>, which are its scalar twins: the same
// bytes on every SIMD target.
#pragma once

#include "nodes/kernels/fragment_counts.h"

namespace frustum::kernels::simd {

void fill_fragments(const FragmentScene<float>& scene, PixelRect rect, const FragmentLayers<float>& to,
                    const FragmentScratch<float>& scratch);

FragmentCounts count_fragments(const FragmentScene<float>& scene, int column, int row, std::uint32_t limit);

}  // namespace frustum::kernels::simd
