// From values of corners to values of vertices.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"

#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

struct VertexSplit {
  Ref<Column> triangles;                // of the new vertices
  std::vector<std::uint32_t> vertices;  // of each new vertex: the old one
  std::vector<std::uint32_t> corners;   // of each new vertex: a corner (3 f + c) that it stands for
};

// One vertex for each distinct (vertex, values of its corner in the columns) by bits, in the order of first use;
// vertices that no face uses go. Claims what it takes before it takes it: 24 bytes a face and 4 a vertex, then 8 a new
// vertex. Throws Cancelled. Cost: linear, and a sort of the corners of each vertex.
VertexSplit split_vertices(const Mesh& mesh, std::span<const Ref<Column>> corner_columns, Context& ctx);

// The same triangles with every real column of corners made one of vertices by split_vertices, whose cost it has, and
// the new columns. A mesh without such columns is returned as it is; corners keep their other columns.
Mesh split_corners(const Mesh& mesh, Context& ctx);

}  // namespace frustum
