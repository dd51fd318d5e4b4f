// Layers of colour over one another, sample by sample.
#pragma once

#include "nodes/kernels/composite.h"
#include "nodes/kernels/simd/composite.h"

namespace frustum::compositing {

// See kernels::composite_layers: with vectors for single precision, the same bytes on every target.
template <std::floating_point R>
void composite_row(const kernels::LayerRows<R>& in, std::size_t n, const std::array<R*, 4>& out) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::composite_layers(in, n, out);
  else
    kernels::composite_layers(in, n, out);
}

}  // namespace frustum::compositing
