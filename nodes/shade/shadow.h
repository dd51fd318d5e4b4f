// The way from a point to a light.
#pragma once

#include "nodes/kernels/lighting.h"
#include "nodes/kernels/triangle_tree.h"

namespace frustum::shadow {

/// Lights without a place are seen along a way that does not end: what stands behind a lamp does not hide it
/// (errata E45), but nothing stands behind the sun.
inline kernels::Sight sight(const glm::dvec3& p, const kernels::LightSource<double>& light) {
  const glm::dvec3 place(light.place[0], light.place[1], light.place[2]);
  return light.is_point ? kernels::Sight{p, place - p, true} : kernels::Sight{p, place, false};
}

}  // namespace frustum::shadow
