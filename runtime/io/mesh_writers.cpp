#include "runtime/io/mesh_writers.h"

#include "runtime/core/error.h"

#include <fmt/format.h>

namespace frustum {

void warn_left_out(const SaveRequest& request, std::string_view format, std::string_view what) {
  if (request.warn) request.warn("left_out", fmt::format("{} has no place for {}", format, what));
}

namespace {

// Readers refuse such positions, ours too; .csv and .json are for looking at them.
void require_finite(const Column& position, std::string_view extension, const std::string& path) {
  for (std::size_t i = 0; i < position.rows(); ++i) {
    const double x = position.number(i, 0), y = position.number(i, 1), z = position.number(i, 2);
    if (std::isfinite(x) && std::isfinite(y) && std::isfinite(z)) continue;
    throw NodeError(
        "format_cannot_hold",
        fmt::format("{}: vertex {} is at ({}, {}, {}), and .{} holds finite positions alone; .csv "
                    "and .json hold all",
                    path, i, as_text(x), as_text(y), as_text(z), extension));
  }
}

}  // namespace

void write_mesh(const Mesh& mesh, std::string_view extension, const SaveRequest& request, PartialFile& to,
                Context& ctx) {
  const Column& position = mesh.at("position");
  if (position.width() != 3)
    throw NodeError("format_cannot_hold",
                    fmt::format("{}: positions in {} space have four numbers, and .{} holds three",
                                request.path, name_of(position.space()), extension));
  require_finite(position, extension, request.path);
  if (extension == "ply")
    write_ply(mesh, request, to, ctx);
  else if (extension == "obj")
    write_obj(mesh, request, to, ctx);
  else
    write_gltf(mesh, extension == "glb", request, to, ctx);
}

}  // namespace frustum
