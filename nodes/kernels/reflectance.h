// How much light a highlight sends back.
#pragma once

#include "nodes/kernels/elementary.h"

namespace frustum::kernels {

/// Shares of the light that comes straight down which leave again, over the hemisphere: the integral of the
/// highlight times the cosine, over pi, for a highlight of 1. Lobes are not normalised, so a small exponent
/// reflects more.
///   Phong  integral of cos^(n+1)                      = 2 pi / (n + 2)
///   Blinn  integral of cos^n(theta / 2) cos(theta)    = 8 pi (n + 2^(-n/2)) / ((n + 2) (n + 4))
/// Source of the second: Giesen 2009, Phong and Blinn-Phong normalization factors.
inline double phong_reflectance(double n) { return 2 / (n + 2); }
inline double blinn_reflectance(double n) { return 8 * (n + exp2(-n / 2)) / ((n + 2) * (n + 4)); }

}  // namespace frustum::kernels
