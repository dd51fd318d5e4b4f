// A checkerboard over (u, v); nodes/kernels/checkerboard.h evaluates and filters it.
#pragma once

#include <cmath>

namespace frustum {

/// Whether squares of side 1 / scale are a checkerboard: their side is a finite positive number.
inline bool is_checker_scale(double scale) { return scale > 0 && std::isfinite(scale); }

}  // namespace frustum
