// The vector twins of nodes/kernels/texture_lookup.h for float: the same bits, on every target.
#pragma once

#include "nodes/kernels/texture_lookup.h"

namespace frustum::kernels::simd {

/// Bilinear and trilinear lookup of pyramids without a border, ellipses, and the checkerboard; the rest is
/// the scalar code itself. Cost on AVX-512, trilinear: about 25 cycles a covered point; nothing is fetched
/// where a vector has no point.
void look_up(const TexelPyramid& pyramid, const Filtering& filter, const UvRows<float>& in, std::size_t n,
             const RgbaRows<float>& out);
void look_up(const CheckerColors<float>& checker, const Filtering& filter, const UvRows<float>& in,
             std::size_t n, const RgbaRows<float>& out);

}  // namespace frustum::kernels::simd
