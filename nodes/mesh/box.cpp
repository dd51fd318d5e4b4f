#include "nodes/mesh/box.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  glm::dvec3 size{2};
};
struct Outputs {
  Ref<Mesh> mesh;
};

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    using Uv = glm::vec<2, R>;
    auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, mesh::box_faces);
    auto position = Column::make<Point>("position", Domain::vertex, mesh::box_vertices, Space::object);
    auto normal = Column::make<Point>("normal", Domain::corner, 3 * mesh::box_faces, Space::object);
    auto uv = Column::make<Uv>("uv", Domain::corner, 3 * mesh::box_faces);
    mesh::box_positions<R>(p.size, position->template values<Point>());
    mesh::box_corners<R>(triangle->values<glm::uvec3>(), normal->template values<Point>(),
                         uv->template values<Uv>());
    out->columns = {triangle, position, normal, uv};
  });
  out->closed = true;
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_box() {
  return node("mesh.box", run)
      .doc("Makes a closed box around the origin, with sharp edges: 8 vertices, 12 triangles.")
      .param("size", &Params::size, "Lengths along x, y and z.",
             {.unit = "world units", .range = {.low = 0, .high = 1e30, .open_low = true}})
      .output(
          "mesh", &Outputs::mesh,
          "Vertices are shared, so the box is watertight; normal and uv (a square a side) are at corners.",
          {.space = Space::object});
}

}  // namespace frustum
