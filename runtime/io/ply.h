// Meshes from PLY files (the Stanford polygon format), text and binary of both byte orders.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/param.h"

#include <string_view>

namespace frustum {

// Vertices keep their order and number. Elements and properties may stand in any order and have any type.
//
//   element "vertex"                                       column
//   x y z                                                  position, object space; must be there and finite
//   nx ny nz                                               normal, made unit length
//   u v, s t, texture_u texture_v or texture_s texture_t   uv; v goes up, as in OBJ
//   uv1_x uv1_y to uv15_x uv15_y                           uv1 to uv15, as write_ply names them
//   red green blue [alpha], also diffuse_red ...           color: whole numbers are sRGB (0 to 255 or 65535),
//                                                          as the pictures and scanners are that they come
//                                                          from, and are decoded to linear Rec.709; real ones
//                                                          are taken as linear. The format itself says
//                                                          nothing. Alpha is linear.
//   any other number                                       a column of its name (with "ply_" before it where
//                                                          the name has a meaning here): f32, f64, i32 or u32
//   element "face"
//   vertex_indices or vertex_index                         triangle; polygons are cut
//                                                          (runtime/io/triangulate.h), fewer than 3 corners
//                                                          are left out and counted
//   texcoord (a list of u v for every corner)              uv of corners
//   red green blue [alpha] ...                             color of corners, as above, where vertices have none
//   any other number                                       a face column, as above; "face_" stands before a
//                                                          name that vertices have too
//   element "tristrips": vertex_indices                    triangle; -1 begins a new strip
//
// Reals have ctx.precision. Other elements and lists are skipped, and so is the picture that a comment
// "TextureFile" names (warning "properties_skipped"). Normals that
// are missing, without length or not finite are made as in read_obj ("normals_computed"); a file of points is
// a mesh without faces and, where it states none, without normals ("no_faces"). Further warnings:
// "faces_skipped", "uv_missing", "polygon_fan", "trailing_bytes".
//
// Every count is held against the bytes that are there before anything is allocated: memory stays below a
// small multiple of the file's size. Throws NodeError("malformed_file") with file:line, or byte and row.
// Cost: 1 million triangles, binary, in some 0.05 s on two cores; text in 0.2 s.
// Source: Turk 1994, The PLY Polygon File Format.
Mesh read_ply(std::string_view bytes, const FilePath& file, Context& ctx);

}  // namespace frustum
