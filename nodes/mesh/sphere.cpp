#include "nodes/mesh/sphere.h"

#include "nodes/mesh.h"
#include "runtime/buffers/round_mesh.h"
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
  return {make_round_mesh(
      shape, ctx,
      [&]<class P>(std::span<P> position, std::span<P> normal) {
        mesh::sphere_vertices<typename P::value_type>(shape, position, normal);
      },
      [&]<class Uv>(std::span<glm::uvec3> triangle, std::span<Uv> uv) {
        mesh::sphere_faces<typename Uv::value_type>(shape, triangle, uv);
      })};
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
