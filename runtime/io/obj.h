// Meshes from Wavefront OBJ text.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <string_view>

namespace frustum {

// Reads v, vt, vn, f (polygons become triangles; negative indices count backwards) and usemtl; other
// statements are counted.
//
// Vertices are the distinct triples (v, vt, vn) that faces use, in the order of v and then of first use:
// where a file has no seams, vertex i is its i-th v. Columns, in ctx.precision:
//   triangle, position (object space), normal, uv (where any corner has one), material (with usemtl)
// Normals are made unit length. A normal that is missing or has no length is the sum of the normals of the
// faces around its v, weighted by area (0 0 1 where that has no length either); warnings
// "normals_computed", "uv_missing", "polygon_fan", "statements_skipped" and "no_faces" say so. Materials
// have the names of the file and default values.
//
// `file` is for messages. Throws NodeError("malformed_file") with file:line, WorldError("out_of_memory").
// Cost: 1 million triangles with normals and uv (90 MB) in some 0.2 s on two cores.
Mesh read_obj(std::string_view text, const FilePath& file, Context& ctx);

}  // namespace frustum
