#include "nodes/shade/transparency.h"

#include "nodes/shade.h"
#include "runtime/buffers/transparency.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  double opacity = 0.5;
  std::optional<std::string> only = {};
};
struct Outputs {
  Ref<Mesh> mesh;
};

std::optional<std::uint32_t> number_of(const Mesh& mesh, const std::optional<std::string>& name) {
  if (!name) return {};
  if (mesh.materials && mesh.find("material") != nullptr) {
    const auto& materials = mesh.materials->materials;
    for (std::uint32_t i = 0; i < materials.size(); ++i)
      if (materials[i].name == *name) return i;
  }
  throw NodeError("unknown_material", fmt::format("no material of the mesh has the name '{}'", *name),
                  at_param("only"));
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Mesh& mesh = *in.mesh;
  const auto only = number_of(mesh, p.only);
  const Column* before = transparency_of(mesh);
  return ctx.real([&]<class R>() -> Outputs {
    const auto column = Column::make<R>(transparency_column, Domain::face, mesh.faces());
    const auto values = column->template values<R>();
    for (std::size_t f = 0; f < values.size(); ++f)
      values[f] = before == nullptr ? R(0) : static_cast<R>(before->number(f, 0));
    const auto of = only ? mesh.at("material").values<std::uint32_t>() : std::span<const std::uint32_t>();
    ctx.count("faces", set_transparency(values, of, only, static_cast<R>(1 - p.opacity)));
    return {std::make_shared<const Mesh>(mesh.with(column))};
  });
}

}  // namespace

NodeType nodes::shade_transparency() {
  return node("shade.transparency", run)
      .doc("Lets what lies behind faces shine through them, all of them or those of one material.")
      .cite("Porter & Duff 1984, Compositing digital images, doi:10.1145/964965.808606 (opacity as coverage)")
      .covers(42)
      .input("mesh", &Inputs::mesh, "Faces in any space.")
      .param("opacity", &Params::opacity,
             "Share of the light that is the face's own; lowering it shows what is behind.",
             {.range = between(0, 1)})
      .param("only", &Params::only, "Only faces whose material has this name; null changes all.")
      .output("mesh", &Outputs::mesh,
              "The same with a column transparency, 1 - opacity by face; 0 where none was set.");
}

}  // namespace frustum
