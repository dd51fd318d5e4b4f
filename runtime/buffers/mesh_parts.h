// Meshes put together from parts: what merging and instancing have in common.
#pragma once

#include "runtime/buffers/mesh.h"

#include <cstddef>

namespace frustum {

// Bytes of one row of a column.
inline std::size_t row_bytes(const Column& c) {
  return static_cast<std::size_t>(c.width()) * bytes_of(c.kind());
}

// The same kind of column with room for `rows` rows, not initialised.
std::shared_ptr<Column> column_like(const Column& c, std::size_t rows);

// Throws NodeError("too_large") where vertices or faces could no longer be numbered in 32 bits.
void require_countable(std::size_t vertices, std::size_t faces);

// Copies all rows of a column to those of `to` from `first` on. Requires the same width and kind.
void copy_rows(const Column& from, Column& to, std::size_t first);

// Copies the rows of a corner column likewise, with the second and third corner of every face exchanged:
// what goes with a triangle whose winding was reversed.
void copy_reversed_corners(const Column& from, Column& to, std::size_t first);

// Where the corners of each face find the values of a vertex column: the column on corners.
Ref<Column> on_corners(const Column& vertex_column, std::span<const glm::uvec3> triangles);

}  // namespace frustum
