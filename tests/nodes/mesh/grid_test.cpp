#include "nodes/mesh/grid.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

Ref<Mesh> grid(const Json& params) { return test::run_node(nodes::mesh_grid(), params).at(0).as<Mesh>(); }

TEST(MeshGrid, IsTwoTrianglesThatFaceUp) {
  const auto m = grid({{"size", {4, 2}}});
  EXPECT_EQ(test::column<glm::vec3>(*m, "position"),
            (std::vector<glm::vec3>{{-2, 0, 1}, {2, 0, 1}, {-2, 0, -1}, {2, 0, -1}}));
  EXPECT_EQ(test::column<glm::uvec3>(*m, "triangle"), (std::vector<glm::uvec3>{{0, 1, 3}, {0, 3, 2}}));
  EXPECT_EQ(test::column<glm::vec2>(*m, "uv"), (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}));
  EXPECT_EQ(m->space(), Space::object);
}

TEST(MeshGrid, IsConsistentAndHasOneBorder) {
  const auto m = grid({{"size", {3, 5}}, {"segments", {7, 4}}});
  test::expect_consistent(*m);
  EXPECT_EQ(test::statistic(m, "euler_characteristic"), 1);
  EXPECT_EQ(test::statistic(m, "edges_boundary"), 2 * (7 + 4));
  EXPECT_NEAR(test::statistic(m, "area"), 15, 1e-6);
}

TEST(MeshGrid, RepeatsItsTexture) {
  const auto uv = test::column<glm::vec2>(*grid({{"repeat", {3, 20}}}), "uv");
  EXPECT_EQ(uv[0], glm::vec2(0, 0));
  EXPECT_EQ(uv[3], glm::vec2(3, 20));
}

TEST(MeshGrid, TakesTheLargestSizeAndRefusesNone) {
  const auto m = grid({{"size", {1e30, 1e30}}});
  EXPECT_EQ(m->at("position").health().positive_infinity, 0U);
  EXPECT_THROW(grid({{"size", {0, 1}}}), std::runtime_error);
  EXPECT_THROW(grid({{"segments", {0, 1}}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
