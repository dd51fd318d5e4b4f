#include "nodes/shade/transparency.h"

#include "nodes/mesh.h"
#include "nodes/shade.h"
#include "runtime/buffers/transparency.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

using testing::Each;
using testing::ElementsAre;

Ref<Mesh> three_faces() {
  Mesh m = test::mesh_of<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}},
                                    Space::world);
  const std::uint32_t material[] = {1, 0, 1};
  m.columns.push_back(Column::make<std::uint32_t>("material", Domain::face, material));
  auto set = std::make_shared<MaterialSet>();
  set->materials = {Material{.name = "wood"}, Material{.name = "glass"}};
  m.materials = set;
  return test::shared(std::move(m));
}

Ref<Mesh> run(const Ref<Mesh>& mesh, const Json& params) {
  return test::run_node(nodes::shade_transparency(), params, {{Buffer(mesh)}})[0].as<Mesh>();
}

TEST(ShadeTransparency, AllFacesGetIt) {
  const auto m = run(three_faces(), {{"opacity", 0.25}});
  EXPECT_THAT(test::column<float>(*m, "transparency"), Each(0.75F));
}

TEST(ShadeTransparency, OneMaterialGetsItAndTheOthersKeepTheirs) {
  const auto glass = run(three_faces(), {{"opacity", 0.25}, {"only", "glass"}});
  EXPECT_THAT(test::column<float>(*glass, "transparency"), ElementsAre(0.75F, 0, 0.75F));
  const auto both = run(glass, {{"opacity", 0.5}, {"only", "wood"}});
  EXPECT_THAT(test::column<float>(*both, "transparency"), ElementsAre(0.75F, 0.5F, 0.75F));
  EXPECT_EQ(test::run_error(nodes::shade_transparency(), {{"only", "gold"}}, {{Buffer(three_faces())}}).first,
            "unknown_material");
}

TEST(ShadeTransparency, MergedPartsWithoutItAreOpaque) {
  const auto merged =
      test::run_node(nodes::mesh_merge(), nlohmann::json::object(),
                     {{Buffer(three_faces()), Buffer(run(three_faces(), {{"opacity", 0.5}}))}})[0]
          .as<Mesh>();
  EXPECT_THAT(test::column<float>(*merged, "transparency"), ElementsAre(0, 0, 0, 0.5F, 0.5F, 0.5F));
}

TEST(ShadeTransparency, AColumnOfAnotherShapeIsRefused) {
  Mesh m = *three_faces();
  m.columns.push_back(Column::make<float>("transparency", Domain::vertex, 3));
  EXPECT_EQ(
      test::run_error(nodes::shade_transparency(), nlohmann::json::object(), {{Buffer(test::shared(m))}})
          .first,
      "wrong_column");
}

}  // namespace
}  // namespace frustum
