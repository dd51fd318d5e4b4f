// The vector twins of nodes/kernels/resolve.h for float: the same bits, on every target.
#pragma once

#include "nodes/kernels/resolve.h"

namespace frustum::kernels::simd {

/// Cost on AVX-512 for four planes: about 16 instructions a sample in reach and 16 pixels; pixels in a flat
/// neighbourhood cost next to nothing.
void resolve_row(const ResolveWeights<float>& weights, const ResolveRow<float>& row);

void find_equal_samples(const float* first, int samples, std::ptrdiff_t stride, std::size_t n,
                        std::uint32_t* equal, std::uint32_t* bits);

void find_equal_neighbours(const std::uint32_t* equal, const std::uint32_t* bits,
                           std::span<const std::ptrdiff_t> distance, std::size_t n, std::uint32_t* out);

}  // namespace frustum::kernels::simd
