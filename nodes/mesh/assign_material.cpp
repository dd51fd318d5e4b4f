#include "nodes/mesh/assign_material.h"

#include "nodes/mesh.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  Ref<Material> material;
};
struct Params {
  std::int64_t first = 0;
  std::optional<std::int64_t> count;
  std::optional<std::string> instead_of;
};
struct Outputs {
  Ref<Mesh> mesh;
};

std::vector<Material> materials_of(const Mesh& mesh) {
  if (mesh.materials && !mesh.materials->materials.empty()) return mesh.materials->materials;
  return {Material{}};
}

// Marks the materials that are replaced.
std::vector<std::uint8_t> chosen(const std::vector<Material>& all, const std::optional<std::string>& name) {
  std::vector<std::uint8_t> marks;
  std::string known;
  for (const Material& m : all) {
    marks.push_back(!name || m.name == *name ? 1 : 0);
    known += fmt::format("{}'{}'", known.empty() ? "" : ", ", m.name);
  }
  if (std::find(marks.begin(), marks.end(), 1) == marks.end())
    throw NodeError("unknown_material", fmt::format("the mesh has no material '{}'; it has {}", *name, known),
                    at_param("instead_of"));
  return marks;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const Mesh& mesh = *in.mesh;
  const std::size_t faces = mesh.faces();
  const auto first = static_cast<std::size_t>(p.first);
  if (first > faces || (p.count && static_cast<std::size_t>(*p.count) > faces - first))
    throw NodeError("no_such_faces",
                    fmt::format("faces {} to {} are asked for, and the mesh has {}", first,
                                p.count ? p.first + *p.count - 1 : p.first, faces),
                    at_param("first"));
  std::vector<Material> materials = materials_of(mesh);
  const auto marks = chosen(materials, p.instead_of);
  auto of = Column::make<std::uint32_t>("material", Domain::face, faces);
  const auto ids = of->values<std::uint32_t>();
  if (const Column* old = mesh.find("material"))
    std::ranges::copy(old->values<std::uint32_t>(), ids.begin());
  else
    std::fill(ids.begin(), ids.end(), 0);
  const auto number = static_cast<std::uint32_t>(materials.size());
  const std::size_t changed =
      mesh::assign(ids, first, p.count ? static_cast<std::size_t>(*p.count) : faces - first, marks, number);
  ctx.count("faces_assigned", changed);

  auto set = std::make_shared<MaterialSet>();
  auto out = std::make_shared<Mesh>(mesh);
  if (changed == faces) {  // the others would never be seen
    set->materials = {*in.material};
    std::erase_if(out->columns, [](const auto& c) { return c->name() == "material"; });
  } else {
    materials.push_back(*in.material);
    set->materials = std::move(materials);
    *out = out->with(std::move(of));
  }
  out->materials = std::move(set);
  return {std::move(out)};
}

}  // namespace

NodeType nodes::mesh_assign_material() {
  return node("mesh.assign_material", run)
      .doc("Gives all faces, a range of them, or those of one material a new material.")
      .input("mesh", &Inputs::mesh, "Faces in the order of the mesh.")
      .input("material", &Inputs::material, "What the faces are made of from here on.")
      .param("first", &Params::first, "The first face that changes; raising it leaves more as they are.",
             {.range = at_least(0)})
      .param("count", &Params::count, "How many faces change; null goes to the last.", {.range = at_least(0)})
      .param("instead_of", &Params::instead_of,
             "Only faces whose material has this name, such as one of the file's; null changes any.")
      .output("mesh", &Outputs::mesh, "The same geometry; its other materials keep their numbers.");
}

}  // namespace frustum
