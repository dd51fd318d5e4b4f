// How much of a picture its meshes cover, as far as that is known before a pixel is filled.
#pragma once

#include "runtime/app/session.h"
#include "runtime/buffers/mesh.h"

#include <vector>

namespace frustum {

// The areas of the faces on the screen, each no larger than what of its box lies in the picture, over that of the picture;
// at most 1. An upper bound: faces behind others count too. Of a mesh that is not in screen space, 1. Linear in the faces.
double covered_share(const Mesh&);

// Outputs that hold a mesh in screen space.
std::vector<PortRef> screen_meshes(const Graph&);

// By node, the largest share of those meshes that it depends on; 1 where it depends on none, or the run did not make them.
std::vector<double> covered_shares(const Graph&, const RunResult&);

}  // namespace frustum
