// Triangles of several meshes over one list of vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "nodes/kernels/parallel.h"

namespace frustum::mesh {

// to[i] = from[i] + first: numbers of vertices, faces or materials behind those of
// the meshes before. T is an integer or a vector of them. Requires equal sizes and no overflow.
template <class T>
void renumber(std::span<const T> from, std::uint32_t first, std::span<T> to) {
  kernels::parallel_blocks(from.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) to[i] = from[i] + first;
  });
}

}  // namespace frustum::mesh
