#include "nodes/mesh/statistics.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

#include <cmath>

namespace frustum {
namespace {

TEST(MeshStatistics, CountACube) {
  const auto m = test::run_node(nodes::mesh_box(), {{"size", {1, 1, 1}}}).at(0).as<Mesh>();
  const auto is = [&](const std::string& quantity) { return test::statistic(m, quantity); };
  EXPECT_EQ(is("vertices"), 8);
  EXPECT_EQ(is("faces"), 12);
  EXPECT_EQ(is("edges"), 18);
  EXPECT_EQ(is("components"), 1);
  EXPECT_EQ(is("euler_characteristic"), 2);
  EXPECT_EQ(is("closed"), 1);
  EXPECT_EQ(is("area"), 6);
  EXPECT_EQ(is("volume"), 1);
  EXPECT_EQ(is("shortest_edge"), 1);
  EXPECT_NEAR(is("longest_edge"), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(is("smallest_angle"), 45, 1e-13);
  EXPECT_NEAR(is("largest_angle"), 90, 1e-13);
  EXPECT_NEAR(is("worst_aspect"), std::sqrt(3.0), 1e-15);
}

// A fin on a square (an edge of three faces), a face turned over, one repeated, one collapsed, one of no area.
TEST(MeshStatistics, NameEveryFault) {
  const auto m = test::shared(test::mesh_of(
      std::vector<glm::vec3>{
          {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5F, 0.5F, 1}, {2, 0, 0}, {9, 9, 9}},
      {{0, 1, 2}, {0, 2, 3}, {0, 2, 4}, {1, 2, 5}, {5, 1, 2}, {0, 0, 1}, {0, 1, 5}}, Space::object));
  const auto is = [&](const std::string& quantity) { return test::statistic(m, quantity); };
  EXPECT_EQ(is("vertices"), 7);
  EXPECT_EQ(is("vertices_used"), 6);
  EXPECT_EQ(is("faces_collapsed"), 1);
  EXPECT_EQ(is("faces_without_area"), 2);  // the collapsed one, and 0 1 5 on a line
  EXPECT_EQ(is("faces_duplicate"), 1);
  EXPECT_EQ(is("edges_non_manifold"), 3);  // 0 2 with its fin, 1 2 and 1 5
  EXPECT_EQ(is("edges_misoriented"), 2);   // 2 5 by the repeated face, 0 1 by the one without area
  EXPECT_EQ(is("closed"), 0);
}

TEST(MeshStatistics, JoinSeamsOnlyWhenAsked) {
  // A cube whose sides have vertices of their own.
  const auto box = test::run_node(nodes::mesh_box(), Json::object()).at(0).as<Mesh>();
  std::vector<glm::vec3> p;
  std::vector<glm::uvec3> t;
  for (const glm::uvec3& f : box->triangles()) {
    const auto first = static_cast<std::uint32_t>(p.size());
    for (glm::length_t c = 0; c < 3; ++c) p.emplace_back(test::position_at(*box, f[c]));
    t.emplace_back(first, first + 1, first + 2);
  }
  const auto m = test::shared(test::mesh_of(p, t, Space::object));
  EXPECT_EQ(test::statistic(m, "closed", true), 1);
  EXPECT_EQ(test::statistic(m, "closed", false), 0);
  EXPECT_EQ(test::statistic(m, "components", false), 12);
  const auto known = test::run_node(nodes::mesh_statistics(), Json::object(), {{m}}).at(3).as<Mesh>();
  EXPECT_EQ(known->closed, true);
}

TEST(MeshStatistics, HoldForNothingAndForWhatIsNotFinite) {
  const auto empty = test::shared(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::object));
  for (const char* quantity :
       {"faces", "edges", "area", "volume", "closed", "shortest_edge", "smallest_angle"})
    EXPECT_EQ(test::statistic(empty, quantity), 0) << quantity;
  const auto bad =
      test::shared(test::mesh_of(std::vector<glm::vec3>{{NAN, 0, 0}, {1, 0, 0}, {0, INFINITY, 0}, {0, 0, 0}},
                                 {{0, 1, 2}, {0, 1, 3}}, Space::object));
  EXPECT_EQ(test::statistic(bad, "faces_not_finite"), 2);
  EXPECT_EQ(test::statistic(bad, "area"), 0);
  const auto huge = test::shared(test::mesh_of(
      std::vector<glm::vec3>{{0, 0, 0}, {1e30F, 0, 0}, {0, 1e30F, 0}}, {{0, 1, 2}}, Space::object));
  EXPECT_NEAR(test::statistic(huge, "area") / 5e59, 1, 1e-6);
  EXPECT_NEAR(test::statistic(huge, "smallest_angle"), 45, 1e-6);
}

}  // namespace
}  // namespace frustum
