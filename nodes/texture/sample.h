// Texture lookup for rows of points: the vector kernel for float, its scalar twin for double.
#pragma once

#include "nodes/kernels/simd/texture_lookup.h"

#include <concepts>

namespace frustum {

/// Colours of `n` points; see nodes/kernels/texture_lookup.h. Source: TexelPyramid or CheckerColors<R>.
template <std::floating_point R, class Source>
void look_up_row(const Source& source, const kernels::Filtering& filter, const kernels::UvRows<R>& in,
                 std::size_t n, const kernels::RgbaRows<R>& out) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::look_up(source, filter, in, n, out);
  else
    kernels::look_up(source, filter, in, n, out);
}

}  // namespace frustum
