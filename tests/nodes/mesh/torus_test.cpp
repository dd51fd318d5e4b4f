#include "nodes/mesh/torus.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

#include <numbers>

namespace frustum {
namespace {

Ref<Mesh> torus(const Json& params) { return test::run_node(nodes::mesh_torus(), params).at(0).as<Mesh>(); }

TEST(MeshTorus, BeginsAtTheOuterEquatorInFront) {
  const auto m = torus({{"radius", 3}, {"tube", 1}, {"segments", 4}, {"sides", 4}});
  const auto p = test::column<glm::vec3>(*m, "position");
  EXPECT_EQ(p[0], glm::vec3(0, 0, 4));
  EXPECT_EQ(p[1], glm::vec3(0, 1, 3));
  EXPECT_EQ(p[4], glm::vec3(4, 0, 0));
}

TEST(MeshTorus, IsClosedAndConsistentAtEverySize) {
  for (const auto& [segments, sides] : {std::pair{3, 3}, std::pair{64, 32}}) {
    const auto m = torus({{"segments", segments}, {"sides", sides}});
    test::expect_consistent(*m);
    EXPECT_EQ(m->closed, true);
    EXPECT_EQ(test::statistic(m, "closed"), 1);
    EXPECT_EQ(test::statistic(m, "euler_characteristic"), 0);
  }
}

TEST(MeshTorus, HasTheVolumeOfPappus) {
  const auto m = torus({{"radius", 2}, {"tube", 0.5}, {"segments", 512}, {"sides", 256}});
  EXPECT_NEAR(test::statistic(m, "volume"), 2 * std::numbers::pi * std::numbers::pi * 2 * 0.25, 2e-3);
}

TEST(MeshTorus, RefusesWhatIsNoTorus) {
  EXPECT_THROW(torus({{"tube", 0}}), std::runtime_error);
  EXPECT_THROW(torus({{"sides", 2}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
