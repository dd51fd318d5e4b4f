#include "nodes/mesh/torus.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  double radius = 1, tube = 0.4;
  int segments = 64, sides = 32;
};
struct Outputs {
  Ref<Mesh> mesh;
};

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const mesh::TorusShape shape{p.radius, p.tube, static_cast<std::uint32_t>(p.segments),
                               static_cast<std::uint32_t>(p.sides)};
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    using Uv = glm::vec<2, R>;
    const std::size_t n = shape.vertices(), faces = shape.faces();
    auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, faces);
    auto position = Column::make<Point>("position", Domain::vertex, n, Space::object);
    auto normal = Column::make<Point>("normal", Domain::vertex, n, Space::object);
    auto uv = Column::make<Uv>("uv", Domain::corner, 3 * faces);
    mesh::torus_vertices<R>(shape, position->template values<Point>(), normal->template values<Point>());
    mesh::torus_faces<R>(shape, triangle->values<glm::uvec3>(), uv->template values<Uv>());
    out->columns = {triangle, position, normal, uv};
  });
  out->closed = true;
  ctx.count("triangles", out->faces());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_torus() {
  return node("mesh.torus", run)
      .doc("Makes a closed ring around the y axis, with a round tube.")
      .param("radius", &Params::radius, "Of the circle of the tube's centres; raising it widens the hole.",
             {.unit = "world units", .range = {.low = 0, .high = 1e30, .open_low = true}})
      .param("tube", &Params::tube,
             "Radius of the tube; raising it above the other radius makes the ring run into itself.",
             {.unit = "world units", .range = {.low = 0, .high = 1e30, .open_low = true}})
      .param("segments", &Params::segments, "Cross-sections around the axis; raising it makes it rounder.",
             {.range = between(3, 16384)})
      .param("sides", &Params::sides, "Vertices of a cross-section; raising it makes the tube rounder.",
             {.range = between(3, 16384)})
      .output("mesh", &Outputs::mesh,
              "Smooth normals; uv at corners: u around the axis from +z, v around the tube from outside up.",
              {.space = Space::object});
}

}  // namespace frustum
