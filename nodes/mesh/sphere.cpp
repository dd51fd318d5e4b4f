#include "nodes/mesh/sphere.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  double radius = 1;
  int segments = 64, rings = 32;
};
struct Outputs {
  Ref<Mesh> mesh;
};

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const mesh::SphereShape shape{p.radius, static_cast<std::uint32_t>(p.segments),
                                static_cast<std::uint32_t>(p.rings)};
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    using Uv = glm::vec<2, R>;
    const std::size_t n = shape.vertices(), faces = shape.faces();
    auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, faces);
    auto position = Column::make<Point>("position", Domain::vertex, n, Space::object);
    auto normal = Column::make<Point>("normal", Domain::vertex, n, Space::object);
    auto uv = Column::make<Uv>("uv", Domain::corner, 3 * faces);
    mesh::sphere_vertices<R>(shape, position->template values<Point>(), normal->template values<Point>());
    mesh::sphere_faces<R>(shape, triangle->values<glm::uvec3>(), uv->template values<Uv>());
    out->columns = {triangle, position, normal, uv};
  });
  out->closed = true;
  ctx.count("triangles", out->faces());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_sphere() {
  return node("mesh.sphere", run)
      .doc(
          "Makes a closed sphere around the origin, of meridians and circles of latitude, poles on the y "
          "axis.")
      .param("radius", &Params::radius, "Of the sphere, on which all vertices lie.",
             {.unit = "world units", .range = {.low = 0, .high = 1e30, .open_low = true}})
      .param("segments", &Params::segments, "Triangles around the equator; raising it makes it rounder.",
             {.range = between(3, 16384)})
      .param("rings", &Params::rings, "Bands from pole to pole; raising it makes it rounder.",
             {.range = between(2, 16384)})
      .output("mesh", &Outputs::mesh,
              "Smooth normals; uv at corners: u eastwards from +z, v upwards; each pole is one vertex.",
              {.space = Space::object});
}

}  // namespace frustum
