// Vector form of kernels::put_behind<float>, which is its scalar twin: the same bytes on every SIMD target.
#pragma once

#include "nodes/kernels/composite.h"

namespace frustum::kernels::simd {

bool put_behind(const float* red, const float* green, const float* blue, const float* alpha,
                const CompositeSums& to);

}  // namespace frustum::kernels::simd
