#include "nodes/mesh/flat.h"

#include "nodes/mesh.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/material.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <algorithm>

namespace frustum {
namespace flat {
enum class Provoking : std::uint8_t { camera, first, last };
constexpr auto choices(Provoking) {
  return std::array{std::pair{Provoking::camera, "camera"}, std::pair{Provoking::first, "first"},
                    std::pair{Provoking::last, "last"}};
}
}  // namespace flat
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<Camera>> camera;
};
struct Params {
  std::vector<std::string> columns;
  flat::Provoking provoking = flat::Provoking::camera;
};
struct Outputs {
  Ref<Mesh> mesh;
};

bool is_place(const Column& c) { return c.name() == "position" || c.name() == "world"; }
// Columns that a mesh has of vertices or corners only: their faces become flat by three equal corners.
bool is_of_surface(const Column& c) {
  return c.name() == "normal" || c.name() == "color" || is_uv_column(c.name());
}
bool varies(const Column& c) { return c.domain() == Domain::vertex || c.domain() == Domain::corner; }

int corner_of(const Inputs& in, const Params& p) {
  if (p.provoking != flat::Provoking::camera) return p.provoking == flat::Provoking::first ? 0 : 2;
  const Camera* camera = in.camera ? in.camera->get() : in.mesh->camera.get();
  if (camera == nullptr)
    throw NodeError("missing_camera",
                    "which corner counts is a convention of the camera: link one, or say first or last",
                    at_input("camera"));
  return provoking_corner(camera->conventions);
}

// The columns that become those of faces.
std::vector<Ref<Column>> chosen(const Mesh& mesh, const Params& p) {
  std::vector<Ref<Column>> all;
  if (p.columns.empty()) {
    for (const auto& c : mesh.columns)
      if (varies(*c) && !is_place(*c) && (c->kind() == NumberKind::f32 || c->kind() == NumberKind::f64))
        all.push_back(c);
    return all;
  }
  for (std::size_t i = 0; i < p.columns.size(); ++i) {
    const std::string& name = p.columns[i];
    const Column* c = mesh.find(name);
    if (c == nullptr)
      throw NodeError("missing_column", fmt::format("the mesh has no column '{}'", name),
                      at_param(fmt::format("columns/{}", i)));
    if (is_place(*c))
      throw NodeError("wrong_column", fmt::format("'{}' is where vertices are: no face has it", name),
                      at_param(fmt::format("columns/{}", i)));
    if (varies(*c)) all.push_back(mesh.share(name));
  }
  return all;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Mesh& mesh = *in.mesh;
  const int corner = corner_of(in, p);
  auto out = std::make_shared<Mesh>(mesh);
  for (const Ref<Column>& from : chosen(mesh, p)) {
    const std::size_t row = static_cast<std::size_t>(from->width()) * bytes_of(from->kind());
    const bool of_corners = is_of_surface(*from);
    const std::size_t copies = of_corners ? 3 : 1;
    ctx.claim(copies * mesh.faces() * row);
    auto to = std::make_shared<Column>(from->name(), of_corners ? Domain::corner : Domain::face, from->kind(),
                                       from->width(), copies * mesh.faces(), from->space());
    mesh::take_corner(mesh.triangles(), from->domain() == Domain::vertex, corner,
                      static_cast<const std::byte*>(from->data()), row, copies,
                      static_cast<std::byte*>(to->data()));
    *out = out->with(std::move(to));
    ctx.count("columns_made_flat", 1);
    ctx.poll();
  }
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_flat() {
  return node("mesh.flat", run)
      .doc("Gives every face the values of its provoking corner, as APIs do for what is declared flat.")
      .cite("OpenGL 4.6 core profile, 13.6 Flatshading; Vulkan 1.3, Flat Shading and Provoking Vertex")
      .cite(
          "Microsoft, Direct3D 11.3 functional specification, interpolation mode constant: the leading "
          "vertex")
      .covers(56)
      .input("mesh", &Inputs::mesh, "Before it is clipped, which would make new corners.")
      .input("camera", &Inputs::camera,
             "Whose conventions say which corner; left out, the mesh's own camera.")
      .param("columns", &Params::columns,
             "Columns that become flat; empty: all real ones of vertices and corners but the positions.")
      .param("provoking", &Params::provoking,
             "Which corner of a face counts: its first, its last (OpenGL), or as the camera's API has it.")
      .knob_of_taste({"first", "last"}, "Faces take the value of one corner or of another.")
      .output("mesh", &Outputs::mesh,
              "The same geometry; what was chosen has one value a face: normals, colours and uv at its three "
              "corners.");
}

}  // namespace frustum
