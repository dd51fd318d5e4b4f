// Meshes from Wavefront OBJ text.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <string_view>

namespace frustum {

// Reads v (with colours after its coordinates), vt, vn, f (polygons become triangles; negative indices count
// backwards), g, o, usemtl and mtllib; other statements are counted.
//
// Vertices are the distinct triples (v, vt, vn) that faces use, in the order of v and then of first use:
// where a file has no seams, vertex i is its i-th v. Columns, in ctx.precision:
//   triangle, position (object space), normal, uv (where any corner has one),
//   color      where any v has red, green and blue after it (white where it has not): taken as sRGB, which is
//              what programs write there, and decoded to linear Rec.709
//   group      where faces are in several groups: a number for each pair of `o` and `g`, in the order of
//              first use
//   material   with usemtl
// Normals are made unit length. A normal that is missing or has no length is the sum of the normals of the
// faces around its v, weighted by area (0 0 1 where that has no length either); warnings
// "normals_computed", "uv_missing", "polygon_fan", "statements_skipped" and "no_faces" say so. Materials
// are those of the MTL files that mtllib names (mtl.h).
//
// `file` is for messages. Throws NodeError("malformed_file") with file:line, WorldError("out_of_memory").
// Cost: 1 million triangles with normals and uv (90 MB) in some 0.2 s on two cores.
Mesh read_obj(std::string_view text, const FilePath& file, Context& ctx);

}  // namespace frustum
