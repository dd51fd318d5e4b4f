#include "nodes/mesh/statistics.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

#include <numbers>
#include <numeric>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  bool join = true;
};
struct Outputs {
  Ref<Table> table;
  Ref<Number> area, volume;
  Ref<Mesh> mesh;
};

struct Measured {
  mesh::Topology topology;
  mesh::Shapes shapes;
  kernels::SurfaceMeasures surface;
};

Measured measure(const Mesh& mesh, bool join, const Context& ctx) {
  return ctx.real([&]<class R>() -> Measured {
    const auto position = mesh.real<R>("position");
    const kernels::Triangles<R> triangles{position->template values<glm::vec<3, R>>(), mesh.triangles()};
    std::vector<std::uint32_t> place(mesh.vertices());
    if (join)
      place = kernels::equal_points<R>(triangles.position);
    else
      std::iota(place.begin(), place.end(), 0U);
    ctx.poll();
    Measured m{mesh::topology_of(mesh.triangles(), place), {}, {}};
    ctx.poll();
    m.shapes = mesh::shapes_of(triangles);
    m.surface = kernels::measures_of(triangles, kernels::bounds_of(triangles));
    return m;
  });
}

// One quantity a row, with its unit.
class Rows {
 public:
  template <class T>
  void add(std::string name, T value, std::string unit = {}) {
    quantity_.push_back(std::move(name));
    value_.push_back(static_cast<double>(value));
    unit_.push_back(std::move(unit));
  }
  Table table() && {
    Table t;
    t.columns = {{.name = "quantity", .texts = std::move(quantity_)},
                 {.name = "value", .numbers = std::move(value_)},
                 {.name = "unit", .texts = std::move(unit_)}};
    return t;
  }

 private:
  std::vector<std::string> quantity_, unit_;
  std::vector<double> value_;
};

Table table_of(const Mesh& mesh, const Measured& m) {
  constexpr double degrees = 180 / std::numbers::pi;
  const auto& t = m.topology;
  Rows rows;
  rows.add("vertices", mesh.vertices());
  rows.add("vertices_used", t.vertices);
  rows.add("faces", mesh.faces());
  rows.add("faces_collapsed", t.collapsed);
  rows.add("faces_without_area", m.shapes.without_area);
  rows.add("faces_not_finite", m.shapes.not_finite);
  rows.add("faces_duplicate", t.duplicate);
  rows.add("edges", t.edges);
  rows.add("edges_boundary", t.boundary);
  rows.add("edges_non_manifold", t.non_manifold);
  rows.add("edges_misoriented", t.misoriented);
  rows.add("components", t.components);
  rows.add("euler_characteristic", t.euler());
  rows.add("closed", t.closed() ? 1 : 0);
  rows.add("area", m.surface.area, "world units^2");
  rows.add("volume", m.surface.volume, "world units^3");
  rows.add("shortest_edge", m.shapes.shortest_edge, "world units");
  rows.add("longest_edge", m.shapes.longest_edge, "world units");
  rows.add("smallest_angle", m.shapes.smallest_angle * degrees, "degrees");
  rows.add("largest_angle", m.shapes.largest_angle * degrees, "degrees");
  rows.add("worst_aspect", m.shapes.worst_aspect);
  return std::move(rows).table();
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Measured m = measure(*in.mesh, p.join, ctx);
  auto known = std::make_shared<Mesh>(*in.mesh);
  known->closed = m.topology.closed();
  return {std::make_shared<Table>(table_of(*in.mesh, m)), std::make_shared<Number>(Number{m.surface.area}),
          std::make_shared<Number>(Number{m.surface.volume}), std::move(known)};
}

}  // namespace

NodeType nodes::mesh_statistics() {
  return node("mesh.statistics", run)
      .doc("Counts and measures a mesh: edges and holes, Euler characteristic, area, volume, bad triangles.")
      .input("mesh", &Inputs::mesh, "Any triangles; the area and volume of faces that are not finite are 0.",
             {.space = {Space::object, Space::world}})
      .param("join", &Params::join,
             "Whether vertices at one place count as one; without it the seams of a texture are holes.")
      .output("table", &Outputs::table,
              "One row a quantity; faces_collapsed have two corners at one place, and no edges.")
      .output("area", &Outputs::area, "Area of all faces.")
      .output("volume", &Outputs::volume,
              "Volume inside a closed mesh, negative inside out; of little meaning for others.")
      .output("mesh", &Outputs::mesh, "The same mesh, which now knows whether it is closed.");
}

}  // namespace frustum
