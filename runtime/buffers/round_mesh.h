// Closed meshes of smooth vertices, with texture coordinates at corners: what spheres and rings have in common.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/core/context.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>

namespace frustum {

// Columns triangle, position, normal and uv of the shape's vertices() and faces(), in ctx.precision.
//   vertices(position, normal)  fills spans of points
//   faces(triangle, uv)         fills spans of faces and of their corners
// Throws NodeError("memory") before it takes more than the run may have.
template <class Shape, class Vertices, class Faces>
Ref<Mesh> make_round_mesh(const Shape& shape, Context& ctx, const Vertices& vertices, const Faces& faces) {
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    using Uv = glm::vec<2, R>;
    const std::size_t n = shape.vertices(), triangles = shape.faces();
    ctx.claim(n * 2 * sizeof(Point) + triangles * (sizeof(glm::uvec3) + 3 * sizeof(Uv)));
    auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, triangles);
    auto position = Column::make<Point>("position", Domain::vertex, n, Space::object);
    auto normal = Column::make<Point>("normal", Domain::vertex, n, Space::object);
    auto uv = Column::make<Uv>("uv", Domain::corner, 3 * triangles);
    vertices(position->template values<Point>(), normal->template values<Point>());
    faces(triangle->template values<glm::uvec3>(), uv->template values<Uv>());
    out->columns = {triangle, position, normal, uv};
  });
  out->closed = true;
  ctx.count("triangles", out->faces());
  return out;
}

}  // namespace frustum
