// Meshes with some of the faces of another: what culling and clipping have in common.
#pragma once

#include "runtime/buffers/mesh.h"

#include <cstdint>
#include <span>

namespace frustum {

// The faces listed, in that order, each with its corner and face columns; vertex columns are shared, so
// vertices that no face uses any more stay. Face column `origin` is made where there was none. All faces in
// order give the mesh itself. Requires indices < faces. Parallel; the same bytes for any number of threads.
Mesh select_faces(const Mesh& mesh, std::span<const std::uint32_t> faces);
// What select_faces takes for so many faces.
std::uint64_t bytes_of_faces(const Mesh& mesh, std::size_t faces);

// A face or corner column whose element k is that of the old face faces[k]; a corner column moves three rows
// at a time.
Ref<Column> gather_faces(const Column& column, std::span<const std::uint32_t> faces);

// The column whose row k is the old row rows[k]; any domain. Requires rows within the column. Parallel.
Ref<Column> gather_rows(const Column& column, std::span<const std::uint32_t> rows);

// Column `origin` of the mesh, or each face's own number where it has none.
Ref<Column> origin_of(const Mesh& mesh);

}  // namespace frustum
