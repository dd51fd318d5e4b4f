// Meshes as files.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"
#include "runtime/core/partial_file.h"
#include "runtime/core/sink.h"

#include <cmath>
#include <concepts>
#include <limits>
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
//               coordinates turned upside down as glTF has them, others than glTF knows as _NAME; materials with their textures and what of
//               them is seen through, as runtime/io/gltf_material_writer.h says. Both are one file each: a .gltf
//               holds its numbers and pictures inside, as base64
//
// ply and gltf have values of vertices only: vertices are split (vertex_split.h) where a mesh has columns of corners
// that the format holds. The memory of that, and of numbers that gltf holds in another form, is claimed of `ctx`, which
// is polled every few milliseconds. Throws NodeError("format_cannot_hold", "memory"), Cancelled.
void write_mesh(const Mesh& mesh, std::string_view extension, const SaveRequest& request, PartialFile& to,
                Context& ctx);

void write_ply(const Mesh& mesh, const SaveRequest& request, PartialFile& to, Context& ctx);
void write_obj(const Mesh& mesh, const SaveRequest& request, PartialFile& to, Context& ctx);
void write_gltf(const Mesh& mesh, bool binary, const SaveRequest& request, PartialFile& to, Context& ctx);

// A number as texts have it: a NaN has no sign.
template <std::floating_point R>
R as_text(R value) {
  return std::isnan(value) ? std::numeric_limits<R>::quiet_NaN() : value;
}

// Calls request.warn, if there is one.
void warn_left_out(const SaveRequest& request, std::string_view format, std::string_view what);

}  // namespace frustum
