// The edges of a mesh by where they are: vertices at the same position are one, as along a seam of texture
// coordinates.
#pragma once

#include "runtime/buffers/mesh.h"

#include <cstdint>
#include <vector>

namespace frustum {

struct MeshEdge {
  std::uint32_t low, high;          // the first vertices at its ends, low < high
  std::uint32_t forward, backward;  // faces that run from low to high, and from high to low
};

// Every edge once, sorted. Faces with two corners in one place have no area and no edges. -0 and +0 are the
// same place. Cost: a sort of the vertices and one of the edges.
std::vector<MeshEdge> edges_of(const Mesh&);

}  // namespace frustum
