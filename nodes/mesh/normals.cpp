#include "nodes/mesh/normals.h"

#include "nodes/kernels/join_points.h"
#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <numbers>
#include <numeric>

namespace frustum {
namespace mesh {
constexpr auto choices(NormalWeight) {
  return std::array{std::pair{NormalWeight::angle, "angle"}, std::pair{NormalWeight::area, "area"},
                    std::pair{NormalWeight::uniform, "uniform"}};
}
}  // namespace mesh
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  double crease = 60;
  mesh::NormalWeight weight = mesh::NormalWeight::angle;
  bool join = true;
};
struct Outputs {
  Ref<Mesh> mesh;
};

template <class R>
Mesh with_normals(const Mesh& mesh, const Params& p, Context& ctx) {
  using Point = glm::vec<3, R>;
  const auto position = mesh.real<R>("position");
  const kernels::Triangles<R> triangles{position->template values<Point>(), mesh.triangles()};
  const bool smooth = p.crease >= 180;
  const std::size_t rows = smooth ? mesh.vertices() : 3 * mesh.faces();
  // The normals, the place of each vertex, and what sorts them or the corners around each (2 numbers).
  ctx.claim(rows * sizeof(Point) + sizeof(std::uint32_t) * (mesh.vertices() + 2 * 3 * mesh.faces()));
  std::vector<std::uint32_t> place(mesh.vertices());
  if (p.join)
    place = kernels::equal_points<R>(triangles.position);
  else
    std::iota(place.begin(), place.end(), 0U);
  ctx.poll();
  auto normal = Column::make<Point>("normal", smooth ? Domain::vertex : Domain::corner, rows, mesh.space());
  const auto to = normal->template values<Point>();
  const std::size_t without =
      smooth ? mesh::vertex_normals<R>(triangles, place, p.weight, to)
             : mesh::corner_normals<R>(triangles, place, {p.weight, p.crease * std::numbers::pi / 180}, to);
  if (without > 0)
    ctx.warn("normals_without_direction",
             fmt::format("{} {} belong to no face with an area, and got the normal (0, 0, 1)", without,
                         smooth ? "vertices" : "corners"));
  return mesh.with(std::move(normal));
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  auto out = std::make_shared<Mesh>(ctx.real([&]<class R>() { return with_normals<R>(*in.mesh, p, ctx); }));
  ctx.count("normals", out->at("normal").rows());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_normals() {
  return node("mesh.normals", run)
      .doc("Makes the normals of a smooth surface from its triangles, and keeps edges sharp that are.")
      .cite("Thuermer & Wuethrich 1998, Computing vertex normals from polygonal facets, JGT 3(1)")
      .cite("Gouraud 1971, Continuous shading of curved surfaces, doi:10.1109/T-C.1971.223313 (uniform)")
      .input("mesh", &Inputs::mesh, "Triangles; normals that are there already are replaced.",
             {.space = {Space::object, Space::world}})
      .param("crease", &Params::crease,
             "Edges bent by more are sharp; 180 has none, and gives normals to vertices instead of corners.",
             {.unit = "degrees", .range = between(0, 180)})
      .param("weight", &Params::weight,
             "What a face counts for at a corner: its angle there, its area, or the same for all.")
      .param("join", &Params::join,
             "Whether vertices at one place count as one, as the seams of a texture ask for.")
      .output("mesh", &Outputs::mesh,
              "Unit normals; edges of one face, of three or more, or run twice the same way are sharp.");
}

}  // namespace frustum
