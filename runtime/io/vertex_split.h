// From values of corners to values of vertices.
#pragma once

#include "runtime/buffers/column.h"

#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

struct VertexSplit {
  Ref<Column> triangles;                // of the new vertices
  std::vector<std::uint32_t> vertices;  // of each new vertex: the old one
  std::vector<std::uint32_t> corners;   // of each new vertex: a corner (3 f + c) that it stands for
};

// One vertex for each distinct (vertex, values of its corner) by bits, in the order of first use.
VertexSplit split_vertices(std::span<const glm::uvec3> triangles,
                           std::span<const Ref<Column>> corner_columns);

// The rows listed, in that order, as a column of the domain.
Ref<Column> gather_rows(const Column& from, std::span<const std::uint32_t> rows, Domain domain);

}  // namespace frustum
