#include "nodes/mesh/sphere.h"

#include "nodes/kernels/vector.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

#include <numbers>

namespace frustum {
namespace {

Ref<Mesh> sphere(const Json& params, Context* ctx = nullptr) {
  return test::run_node(nodes::mesh_sphere(), params, {}, ctx).at(0).as<Mesh>();
}

TEST(MeshSphere, IsAnOctahedronAtItsSmallest) {
  const auto m = sphere({{"radius", 2}, {"segments", 4}, {"rings", 2}});
  EXPECT_EQ(test::column<glm::vec3>(*m, "position"),
            (std::vector<glm::vec3>{{0, -2, 0}, {0, 0, 2}, {2, 0, 0}, {0, 0, -2}, {-2, 0, 0}, {0, 2, 0}}));
  EXPECT_EQ(m->faces(), 8U);
  EXPECT_NEAR(test::statistic(m, "volume"), 8 * 8.0 / 6, 1e-14);
}

TEST(MeshSphere, IsClosedAndConsistentAtEverySize) {
  for (const auto& [segments, rings] : {std::pair{3, 2}, std::pair{5, 3}, std::pair{64, 32}}) {
    const auto m = sphere({{"segments", segments}, {"rings", rings}});
    EXPECT_EQ(m->faces(), static_cast<std::size_t>(2 * segments * (rings - 1)));
    test::expect_consistent(*m);
    EXPECT_EQ(test::statistic(m, "closed"), 1);
    EXPECT_EQ(test::statistic(m, "euler_characteristic"), 2);
    EXPECT_EQ(test::statistic(m, "vertices_used"), static_cast<double>(m->vertices()));
  }
}

TEST(MeshSphere, HasVerticesOnTheSphereAndNormalsAlongThem) {
  Context ctx;
  ctx.precision = Precision::real_double;
  const auto m = sphere({{"radius", 3}, {"segments", 32}, {"rings", 16}}, &ctx);
  const auto p = test::column<glm::dvec3>(*m, "position"), n = test::column<glm::dvec3>(*m, "normal");
  for (std::size_t i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(kernels::norm(p[i]), 3, 3 * 0x1p-52);
    EXPECT_NEAR(kernels::norm(p[i] - n[i] * 3.0), 0, 3 * 0x1p-52);
  }
  EXPECT_NEAR(test::statistic(sphere({{"segments", 512}, {"rings", 256}}), "volume"),
              4 * std::numbers::pi / 3, 5e-4);
}

// A corner at a pole has the middle of its triangle's u, and v of the pole.
TEST(MeshSphere, DocumentsItsPoles) {
  const auto m = sphere({{"segments", 4}, {"rings", 2}});
  const auto uv = test::column<glm::vec2>(*m, "uv");
  EXPECT_EQ(uv[0], glm::vec2(0.125F, 0));
  EXPECT_EQ(uv[3 * 4 + 2], glm::vec2(0.125F, 1));
}

TEST(MeshSphere, RefusesWhatIsNoSphere) {
  EXPECT_THROW(sphere({{"segments", 2}}), std::runtime_error);
  EXPECT_THROW(sphere({{"rings", 1}}), std::runtime_error);
  EXPECT_THROW(sphere({{"radius", -1}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
