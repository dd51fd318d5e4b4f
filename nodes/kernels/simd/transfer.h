// The vector twin of nodes/kernels/transfer.h for float: the same bits, on every target.
#pragma once

#include "nodes/kernels/transfer.h"

namespace frustum::kernels::simd {

void convert_colors(const ColorMap& map, float* r, float* g, float* b, std::size_t n);

}  // namespace frustum::kernels::simd
