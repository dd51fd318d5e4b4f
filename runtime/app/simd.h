// The vector instructions of the kernels, for front ends and tests.
#pragma once

#include "nodes/kernels/simd/target.h"

namespace frustum {

using kernels::Simd;
using kernels::simd_in_use;
using kernels::use_best_simd;
using kernels::use_simd;

}  // namespace frustum
