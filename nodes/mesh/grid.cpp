#include "nodes/mesh/grid.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  glm::dvec2 size{2};
  glm::ivec2 segments{1};
  glm::dvec2 repeat{1};
};
struct Outputs {
  Ref<Mesh> mesh;
};

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const mesh::GridShape shape{p.size, static_cast<std::uint32_t>(p.segments.x),
                              static_cast<std::uint32_t>(p.segments.y), p.repeat};
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    const std::size_t n = shape.vertices();
    ctx.claim(n * (2 * sizeof(Point) + sizeof(glm::vec<2, R>)) + shape.faces() * sizeof(glm::uvec3));
    auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, shape.faces());
    auto position = Column::make<Point>("position", Domain::vertex, n, Space::object);
    auto normal = Column::make<Point>("normal", Domain::vertex, n, Space::object);
    auto uv = Column::make<glm::vec<2, R>>("uv", Domain::vertex, n);
    mesh::grid_faces(shape, triangle->values<glm::uvec3>());
    mesh::grid_vertices<R>(shape, position->template values<Point>(), uv->template values<glm::vec<2, R>>());
    const auto normals = normal->template values<Point>();
    std::fill(normals.begin(), normals.end(), Point(0, 1, 0));
    out->columns = {triangle, position, normal, uv};
  });
  out->closed = false;
  ctx.count("triangles", out->faces());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_grid() {
  return node("mesh.grid", run)
      .doc("Makes a flat rectangle of triangles in the plane y = 0, facing up.")
      .param("size", &Params::size, "Lengths along x and z; the middle is the origin.",
             {.unit = "world units", .range = {.low = 0, .high = 1e30, .open_low = true}})
      .param("segments", &Params::segments, "Quads along x and z; raising them makes smaller triangles.",
             {.range = between(1, 16384)})
      .param("repeat", &Params::repeat,
             "How often a texture repeats along x and z; raising it makes it smaller.",
             {.range = between(1e-6, 1e6)})
      .output("mesh", &Outputs::mesh, "Two triangles a quad; u along +x, v along -z, normals up.",
              {.space = Space::object});
}

}  // namespace frustum
