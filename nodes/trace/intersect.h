// What rays meet first.
#pragma once

#include "nodes/kernels/ray_beam.h"
#include "nodes/kernels/triangle_tree.h"

namespace frustum::trace {

// A hit as its planes hold it: all 0 and no face where nothing is met.
struct Met {
  std::uint32_t face = 0xFFFFFFFF;
  double t = 0, u = 0, v = 0;
};

inline Met nearest(const kernels::TriangleTree& tree, const kernels::RayBeam& beam, double slack) {
  const kernels::RayHit hit = tree.nearest({beam.origin, beam.along, slack});
  if (hit.face == kernels::RayHit{}.face) return {};
  return {hit.face, hit.t, hit.u, hit.v};
}

}  // namespace frustum::trace
