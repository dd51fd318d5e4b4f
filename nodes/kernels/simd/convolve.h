// The vector twin of nodes/kernels/convolve.h for float: the same bits, on every target.
#pragma once

#include "nodes/kernels/convolve.h"

namespace frustum::kernels::simd {

void weigh_rows(std::span<const float* const> rows, std::span<const float> weight, std::size_t n, float* out);

}  // namespace frustum::kernels::simd
