#include "runtime/io/mesh_writers.h"

#include "runtime/core/error.h"
#include "runtime/io/vertex_split.h"

#include <fmt/format.h>

namespace frustum {

void warn_left_out(const SaveRequest& request, std::string_view format, std::string_view what) {
  if (request.warn) request.warn("left_out", fmt::format("{} has no place for {}", format, what));
}

void write_mesh(const Mesh& mesh, std::string_view extension, const SaveRequest& request, PartialFile& to) {
  const Column& position = mesh.at("position");
  if (position.width() != 3)
    throw NodeError("format_cannot_hold",
                    fmt::format("{}: positions in {} space have four numbers, and .{} holds three",
                                request.path, name_of(position.space()), extension));
  if (extension == "ply")
    write_ply(mesh, request, to);
  else if (extension == "obj")
    write_obj(mesh, request, to);
  else
    write_gltf(mesh, extension == "glb", request, to);
}

Mesh split_corners(const Mesh& mesh) {
  const auto is_corner = [](const Ref<Column>& c) { return c->domain() == Domain::corner; };
  std::vector<Ref<Column>> corner_columns;
  std::copy_if(mesh.columns.begin(), mesh.columns.end(), std::back_inserter(corner_columns), is_corner);
  if (corner_columns.empty()) return mesh;
  const VertexSplit split = split_vertices(mesh.triangles(), corner_columns);
  Mesh out = mesh;
  for (Ref<Column>& c : out.columns) {
    if (c->name() == "triangle")
      c = split.triangles;
    else if (c->domain() == Domain::vertex)
      c = gather_rows(*c, split.vertices, Domain::vertex);
    else if (c->domain() == Domain::corner)
      c = gather_rows(*c, split.corners, Domain::vertex);
  }
  return out;
}

}  // namespace frustum
