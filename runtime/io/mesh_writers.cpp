#include "runtime/io/mesh_writers.h"

#include "runtime/core/error.h"

#include <fmt/format.h>

namespace frustum {

void warn_left_out(const SaveRequest& request, std::string_view format, std::string_view what) {
  if (request.warn) request.warn("left_out", fmt::format("{} has no place for {}", format, what));
}

void write_mesh(const Mesh& mesh, std::string_view extension, const SaveRequest& request, PartialFile& to,
                Context& ctx) {
  const Column& position = mesh.at("position");
  if (position.width() != 3)
    throw NodeError("format_cannot_hold",
                    fmt::format("{}: positions in {} space have four numbers, and .{} holds three",
                                request.path, name_of(position.space()), extension));
  if (extension == "ply")
    write_ply(mesh, request, to, ctx);
  else if (extension == "obj")
    write_obj(mesh, request, to, ctx);
  else
    write_gltf(mesh, extension == "glb", request, to, ctx);
}

}  // namespace frustum
