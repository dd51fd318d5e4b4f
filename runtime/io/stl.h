// Meshes from STL files, text and binary.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <string_view>

namespace frustum {

// A file is binary where its length is that of the number of triangles at byte 80, whatever its header says
// (some begin with "solid"); else text where it begins with "solid" and holds no byte 0, else a binary file
// that is too short or too long.
//
// Columns, in ctx.precision: triangle; position, object space: corners of equal bits (-0 being 0) are one
// vertex, in order of first use, and nothing else is welded; normal, of corners: the unit normal of the
// facet's winding (0 0 1 where it has no area). Where the file has several solids that are not empty, face
// column `group` (u32) counts them from 0. Normals that the file states are held against the winding, and
// those that point to its other side are counted (warning "facet_normals"); their values are not used.
// Further warnings: "no_faces", "trailing_bytes". Colours in the header and the attribute bytes are not
// read: three programs mean three things by them ("properties_skipped").
//
// Throws NodeError("malformed_file") with file:line, or byte and facet, also for corners that are not
// finite. Memory is below a small multiple of the file's size. Cost: n log n; 1 million triangles, binary, in
// some 0.25 s on two cores.
Mesh read_stl(std::string_view bytes, const FilePath& file, Context& ctx);

}  // namespace frustum
