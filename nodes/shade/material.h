// How much light a surface sends back.
#pragma once

#include "nodes/kernels/elementary.h"

#include <glm/vec3.hpp>

#include <algorithm>

namespace frustum {

/// Shares of the light that comes straight down which leave again, over the hemisphere: the integral of the
/// highlight times the cosine, over pi, for a highlight of 1. Lobes are not normalised, so a small exponent
/// reflects more.
///   Phong  integral of cos^(n+1)                      = 2 pi / (n + 2)
///   Blinn  integral of cos^n(theta / 2) cos(theta)    = 8 pi (n + 2^(-n/2)) / ((n + 2) (n + 4))
/// Source of the second: Giesen 2009, Phong and Blinn-Phong normalization factors.
inline double phong_reflectance(double n) { return 2 / (n + 2); }
inline double blinn_reflectance(double n) { return 8 * (n + kernels::exp2(-n / 2)) / ((n + 2) * (n + 4)); }

/// The largest such share over the three channels: above 1 the surface makes light.
///   lobe  share of a highlight of 1; 0 without one
inline double largest_reflectance(const glm::dvec3& diffuse, const glm::dvec3& specular, double lobe) {
  const glm::dvec3 sum = diffuse + specular * lobe;
  return std::max({sum.r, sum.g, sum.b});
}

}  // namespace frustum
