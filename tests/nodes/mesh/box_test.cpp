#include "nodes/mesh/box.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

Ref<Mesh> box(const Json& params) { return test::run_node(nodes::mesh_box(), params).at(0).as<Mesh>(); }

TEST(MeshBox, IsClosedAndConsistent) {
  const auto m = box({{"size", {2, 3, 4}}});
  EXPECT_EQ(m->vertices(), 8U);
  EXPECT_EQ(m->closed, true);
  test::expect_consistent(*m);
  EXPECT_EQ(test::statistic(m, "closed"), 1);
  EXPECT_EQ(test::statistic(m, "euler_characteristic"), 2);
  EXPECT_EQ(test::statistic(m, "volume"), 24);
  EXPECT_EQ(test::statistic(m, "area"), 2 * (6 + 8 + 12));
}

// Seen from outside, the side walls stand upright: v grows with y.
TEST(MeshBox, HasUprightWalls) {
  const auto m = box(Json::object());
  const auto uv = test::column<glm::vec2>(*m, "uv");
  for (std::size_t f = 0; f < m->faces(); ++f)
    for (std::size_t c = 0; c < 3; ++c)
      if (test::normal_at(*m, f, c).y == 0) {
        EXPECT_EQ(uv[3 * f + c].y,
                  test::position_at(*m, m->triangles()[f][static_cast<int>(c)]).y > 0 ? 1 : 0);
      }
}

TEST(MeshBox, RefusesSidesWithoutLength) {
  EXPECT_THROW(box({{"size", {1, 0, 1}}}), std::runtime_error);
  EXPECT_THROW(box({{"size", {1, 1e31, 1}}}), std::runtime_error);
}

}  // namespace
}  // namespace frustum
