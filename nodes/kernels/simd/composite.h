// Vector form of kernels::composite_layers<float>, which is its scalar twin: the same bytes on every SIMD target.
#pragma once

#include "nodes/kernels/composite.h"

namespace frustum::kernels::simd {

void composite_layers(const LayerRows<float>& in, std::size_t n, const std::array<float*, 4>& out);

}  // namespace frustum::kernels::simd
