#include "nodes/mesh/merge.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

Ref<Mesh> merged(const std::vector<Ref<Mesh>>& parts, Context* ctx = nullptr) {
  std::vector<Buffer> links(parts.begin(), parts.end());
  return test::run_node(nodes::mesh_merge(), Json::object(), {links}, ctx).at(0).as<Mesh>();
}

Mesh triangle(float x, Space space = Space::object) {
  return test::mesh_of(std::vector<glm::vec3>{{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}}, {{0, 1, 2}}, space);
}

Ref<MaterialSet> materials(std::initializer_list<const char*> names) {
  auto set = std::make_shared<MaterialSet>();
  for (const char* name : names) set->materials.push_back({.name = name});
  return set;
}

TEST(MeshMerge, PutsVerticesAndFacesBehindOneAnother) {
  const auto m = merged({test::shared(triangle(0)), test::shared(triangle(5, Space::world))});
  EXPECT_EQ(test::column<glm::vec3>(*m, "position")[3], glm::vec3(5, 0, 0));
  EXPECT_EQ(test::column<glm::uvec3>(*m, "triangle"), (std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(m->space(), Space::world);
  EXPECT_EQ(m->validate(), "");
  EXPECT_EQ(m->find("origin"), nullptr);  // each face is its own source, as before
}

TEST(MeshMerge, GivesBackASingleMeshItself) {
  const auto one = test::shared(triangle(0));
  EXPECT_EQ(merged({one}), one);
}

TEST(MeshMerge, NumbersMaterialsAnewAndTakesASharedSetOnce) {
  Mesh a = triangle(0), b = triangle(1), c = triangle(2);
  a.materials = c.materials = materials({"red", "green"});
  b.materials = materials({"blue"});
  const auto material = [](std::uint32_t id) {
    return Column::make<std::uint32_t>("material", Domain::face, std::vector<std::uint32_t>{id});
  };
  a = a.with(material(1)), c = c.with(material(1));
  const auto m = merged({test::shared(a), test::shared(b), test::shared(triangle(9)), test::shared(c)});
  EXPECT_EQ(test::column<std::uint32_t>(*m, "material"), (std::vector<std::uint32_t>{1, 2, 3, 1}));
  ASSERT_EQ(m->materials->materials.size(), 4U);
  EXPECT_EQ(m->materials->materials[2].name, "blue");
  EXPECT_EQ(m->validate(), "");
}

TEST(MeshMerge, KeepsSourcesApart) {
  const Mesh a =
      triangle(0).with(Column::make<std::uint32_t>("origin", Domain::face, std::vector<std::uint32_t>{7}));
  const auto m = merged({test::shared(a), test::shared(triangle(1)), test::shared(a)});
  EXPECT_EQ(test::column<std::uint32_t>(*m, "origin"), (std::vector<std::uint32_t>{7, 8, 16}));
}

TEST(MeshMerge, MovesVertexColumnsToCornersWhereAnotherHasThemThere) {
  const std::vector<glm::vec2> by_vertex = {{0, 0}, {1, 0}, {0, 1}}, by_corner = {{5, 5}, {6, 5}, {5, 6}};
  const Mesh a = triangle(0).with(Column::make<glm::vec2>("uv", Domain::vertex, by_vertex));
  const Mesh b = triangle(1).with(Column::make<glm::vec2>("uv", Domain::corner, by_corner));
  const auto m = merged({test::shared(a), test::shared(b)});
  EXPECT_EQ(m->at("uv").domain(), Domain::corner);
  EXPECT_EQ(test::column<glm::vec2>(*m, "uv"),
            (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {5, 5}, {6, 5}, {5, 6}}));
}

TEST(MeshMerge, FillsWhatIsMissingAndSaysSo) {
  Context ctx;
  const Mesh a = triangle(0).with(
      Column::make<glm::vec3>("normal", Domain::vertex, std::vector<glm::vec3>(3, {0, 0, 1}), Space::object));
  const auto m = merged({test::shared(triangle(0)), test::shared(a)}, &ctx);
  const auto n = test::column<glm::vec3>(*m, "normal");
  EXPECT_EQ(n[0], glm::vec3(0));
  EXPECT_EQ(n[3], glm::vec3(0, 0, 1));
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "column_filled");
}

TEST(MeshMerge, RefusesColumnsThatDoNotFit) {
  const Mesh a = triangle(0).with(Column::make<float>("heat", Domain::vertex, std::vector<float>(3, 1)));
  const Mesh wide =
      triangle(0).with(Column::make<glm::vec2>("heat", Domain::vertex, std::vector<glm::vec2>(3)));
  const Mesh face = triangle(0).with(Column::make<float>("heat", Domain::face, std::vector<float>(1)));
  for (const Mesh& b : {wide, face})
    EXPECT_EQ(
        test::run_error(nodes::mesh_merge(), Json::object(), {{test::shared(a), test::shared(b)}}).first,
        "columns_differ");
  EXPECT_EQ(test::run_error(nodes::mesh_merge(), Json::object(), {{}}).first, "no_meshes");
}

TEST(MeshMerge, KnowsWhatIsClosed) {
  const Mesh ring = test::torus(4, 3, Space::object);
  Mesh open = triangle(0);
  EXPECT_EQ(merged({test::shared(ring), test::shared(ring)})->closed, true);
  EXPECT_EQ(merged({test::shared(ring), test::shared(open)})->closed, std::nullopt);
  open.closed = false;
  EXPECT_EQ(merged({test::shared(open), test::shared(ring)})->closed, false);
}

}  // namespace
}  // namespace frustum
