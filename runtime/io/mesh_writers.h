// Meshes as files.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/partial_file.h"
#include "runtime/core/sink.h"

#include <string_view>

namespace frustum {

// Writes a mesh whose positions have three coordinates. What a format has no place for is left out, with the
// warning "left_out" that names it.
//
//   ply         binary, little-endian: every vertex and face column as its own numbers, bit for bit, so that
//               read_ply gives them back in the precision of the mesh. Materials are numbers without what
//               they mean.
//   obj         text, decimals that read back to the same bits: position, color (sRGB, as other programs
//               write it), uv, normal and names of materials; texture and colours of materials are left out
//   glb, gltf   glTF 2.0, one primitive a material: real vertex columns as f32 (double is rounded), texture
//               coordinates turned upside down as glTF has them; materials with their textures and what of
//               them is seen through, as runtime/io/gltf_material_writer.h says. Both are one file each: a .gltf
//               holds its numbers and pictures inside, as base64
//
// ply and gltf have values of vertices only: a mesh with columns of corners is cut first (split_corners).
// Throws NodeError("format_cannot_hold").
void write_mesh(const Mesh& mesh, std::string_view extension, const SaveRequest& request, PartialFile& to);

void write_ply(const Mesh& mesh, const SaveRequest& request, PartialFile& to);
void write_obj(const Mesh& mesh, const SaveRequest& request, PartialFile& to);
void write_gltf(const Mesh& mesh, bool binary, const SaveRequest& request, PartialFile& to);

// The same triangles with every column of corners made one of vertices: a vertex is there once for each
// different set of values (by bits) that its corners have, in the order of first use; vertices that no face
// uses go. A mesh without columns of corners is returned as it is. Cost: one sort of the corners.
Mesh split_corners(const Mesh& mesh);

// Calls request.warn, if there is one.
void warn_left_out(const SaveRequest& request, std::string_view format, std::string_view what);

}  // namespace frustum
