#include "nodes/mesh/torus.h"

#include "nodes/mesh.h"
#include "runtime/buffers/round_mesh.h"
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
  return {make_round_mesh(
      shape, ctx,
      [&]<class P>(std::span<P> position, std::span<P> normal) {
        mesh::torus_vertices<typename P::value_type>(shape, position, normal);
      },
      [&]<class Uv>(std::span<glm::uvec3> triangle, std::span<Uv> uv) {
        mesh::torus_faces<typename Uv::value_type>(shape, triangle, uv);
      })};
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
