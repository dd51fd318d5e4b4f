#include "nodes/mesh/assign_material.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

const Ref<Material> gold = std::make_shared<const Material>(Material{.name = "gold"});

Mesh strip() {
  return test::mesh_of(std::vector<glm::vec3>(6), {{0, 1, 2}, {1, 2, 3}, {2, 3, 4}, {3, 4, 5}},
                       Space::object);
}

Ref<Mesh> assigned(const Mesh& mesh, const Json& params) {
  return test::run_node(nodes::mesh_assign_material(), params, {{test::shared(mesh)}, {gold}})
      .at(0)
      .as<Mesh>();
}

std::vector<std::string> names(const Mesh& m) {
  std::vector<std::string> out;
  for (const Material& material : m.materials->materials) out.push_back(material.name);
  return out;
}

Mesh two_materials() {
  Mesh m = strip().with(
      Column::make<std::uint32_t>("material", Domain::face, std::vector<std::uint32_t>{0, 1, 1, 0}));
  m.materials =
      std::make_shared<MaterialSet>(MaterialSet{{Material{.name = "roof"}, Material{.name = "wall"}}});
  return m;
}

TEST(MeshAssignMaterial, CoversEverythingByDefault) {
  const auto m = assigned(two_materials(), Json::object());
  EXPECT_EQ(names(*m), std::vector<std::string>{"gold"});
  EXPECT_EQ(m->find("material"), nullptr);
  EXPECT_EQ(m->validate(), "");
}

TEST(MeshAssignMaterial, ChangesARange) {
  const auto m = assigned(strip(), {{"first", 1}, {"count", 2}});
  EXPECT_EQ(test::column<std::uint32_t>(*m, "material"), (std::vector<std::uint32_t>{0, 1, 1, 0}));
  EXPECT_EQ(names(*m), (std::vector<std::string>{"", "gold"}));
  EXPECT_EQ(m->validate(), "");
}

TEST(MeshAssignMaterial, ReplacesAMaterialByName) {
  const auto m = assigned(two_materials(), {{"instead_of", "wall"}, {"first", 2}});
  EXPECT_EQ(test::column<std::uint32_t>(*m, "material"), (std::vector<std::uint32_t>{0, 1, 2, 0}));
}

TEST(MeshAssignMaterial, NamesWhatIsNotThere) {
  const auto error = [](const Json& params) {
    return test::run_error(nodes::mesh_assign_material(), params, {{test::shared(two_materials())}, {gold}});
  };
  EXPECT_EQ(error({{"instead_of", "door"}}).first, "unknown_material");
  EXPECT_NE(error({{"instead_of", "door"}}).second.find("'roof', 'wall'"), std::string::npos);
  EXPECT_EQ(error({{"first", 5}}).first, "no_such_faces");
  EXPECT_EQ(error({{"first", 3}, {"count", 2}}).first, "no_such_faces");
  EXPECT_EQ(error({{"count", 9223372036854775807}}).first, "no_such_faces");
}

}  // namespace
}  // namespace frustum
