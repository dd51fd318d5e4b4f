// Layers of colour over one another, sample by sample.
#pragma once

#include "nodes/kernels/composite.h"
#include "nodes/kernels/simd/composite.h"

namespace frustum::compositing {

// See kernels::put_behind: with vectors for single precision, the same bytes on every target.
template <std::floating_point R>
bool put_row_behind(const R* red, const R* green, const R* blue, const R* alpha,
                    const kernels::CompositeSums& to) {
  if constexpr (sizeof(R) == 4)
    return kernels::simd::put_behind(red, green, blue, alpha, to);
  else
    return kernels::put_behind(red, green, blue, alpha, to);
}

}  // namespace frustum::compositing
