#include "nodes/mesh/bounds.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/value.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {};
struct Outputs {
  Ref<Table> table;
  Ref<Number> diagonal;
  Ref<Matrix> fit;
};

struct Measured {
  kernels::Box box;
  glm::dvec3 centroid;
};

Measured measure(const Mesh& mesh, const Context& ctx) {
  return ctx.real([&]<class R>() -> Measured {
    const auto position = mesh.real<R>("position");
    const kernels::Triangles<R> triangles{position->template values<glm::vec<3, R>>(), mesh.triangles()};
    const kernels::Box box = kernels::bounds_of(triangles);
    return {box, kernels::measures_of(triangles, box).centroid};
  });
}

Ref<Table> table_of(const Measured& m) {
  const glm::dvec3 size = m.box.high - m.box.low;
  const std::pair<const char*, glm::dvec3> rows[] = {{"min", m.box.low},
                                                     {"max", m.box.high},
                                                     {"size", size},
                                                     {"centre", m.box.centre()},
                                                     {"centroid", m.centroid}};
  Table t;
  t.columns = {{.name = "quantity"}, {.name = "x"}, {.name = "y"}, {.name = "z"}};
  for (const auto& [name, v] : rows) {
    t.columns[0].texts.emplace_back(name);
    for (glm::length_t k = 0; k < 3; ++k) t.columns[static_cast<std::size_t>(k) + 1].numbers.push_back(v[k]);
  }
  return std::make_shared<Table>(std::move(t));
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  const Measured m = measure(*in.mesh, ctx);
  if (m.box.empty())
    throw NodeError("no_bounds", "the mesh has no face with a finite corner, so it has no bounds",
                    at_input("mesh"));
  return {table_of(m), std::make_shared<Number>(Number{2 * kernels::norm(m.box.half_size())}),
          std::make_shared<Matrix>(Matrix{mesh::fitting_matrix(m.box)})};
}

}  // namespace

NodeType nodes::mesh_bounds() {
  return node("mesh.bounds", run)
      .doc("Measures the box around a mesh and the centroid of its surface.")
      .input("mesh", &Inputs::mesh, "Only what faces use counts; corners that are not finite do not.",
             {.space = {Space::object, Space::world, Space::eye, Space::ndc}})
      .output("table", &Outputs::table,
              "min, max, size and centre of the box, and the surface's centroid, weighted by area.")
      .output("diagonal", &Outputs::diagonal, "Length of the box's diagonal.")
      .output(
          "fit", &Outputs::fit,
          "Brings the box's centre to the origin and its longest side to -1 ... 1; for transform.affine.");
}

}  // namespace frustum
