#include "nodes/vector/frame.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

TEST(VectorFrame, PutsPointsAtTheirCoordinatesAndLeavesVectorsWithoutTheOrigin) {
  const Json params = {{"origin", {10, 20, 30}}, {"a", {0, 2, 0}}, {"b", {0, 0, 3}}, {"c", {4, 0, 0}}};
  const auto p = test::run_node(nodes::vector_frame(), params, {{test::points({{1, 1, 1}})}});
  EXPECT_EQ(p.at(0).as<Points>()->at.at(0), glm::dvec3(14, 22, 33));
  const auto v = test::run_node(nodes::vector_frame(), params, {{test::vectors({{1, 1, 1}})}});
  EXPECT_EQ(v.at(0).as<Vectors>()->along.at(0), glm::dvec3(4, 2, 3));
  EXPECT_NEAR(p.at(3).as<Number>()->value, 1, 1e-15) << "at right angles, of whatever length";
  EXPECT_EQ(p.at(1).as<Matrix>()->value[3], glm::dvec4(10, 20, 30, 1));
}

TEST(VectorFrame, ComesBackFromItsCoordinates) {
  std::mt19937_64 random(1);
  int tried = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const auto f =
        vector::frame_of(glm::dvec3(1e9, -1e9, 1e9) + test::random_row(random), test::random_row(random),
                         test::random_row(random), test::random_row(random));
    if (!f || f->rcond < 1e-3) continue;
    ++tried;
    const glm::dvec3 p = f->origin + test::random_row(random);
    const glm::dvec3 back = f->world_point(f->frame_point(p));
    // The world's own ulp at 1e9, and 8 u / rcond of coordinates of size 1.
    EXPECT_LE(kernels::largest_component(back - p), 0x1p-23 + 8 * 0x1p-53 / f->rcond);
    const glm::dvec3 v = test::random_row(random);
    EXPECT_LE(kernels::largest_component(f->world_vector(f->frame_vector(v)) - v), 8 * 0x1p-53 / f->rcond);
  }
  EXPECT_GT(tried, 200);
}

TEST(VectorFrame, TakesAFarOriginAwayBeforeItTurns) {
  const auto f = vector::frame_of({1e12, 1e12, 1e12}, {3, 1, 0}, {-1, 3, 0}, {0, 0, 1});
  const glm::dvec3 p = f->origin + glm::dvec3(0.5, 0.25, 0.125);
  const glm::dvec3 exact(0.175, 0.025, 0.125);
  EXPECT_LE(kernels::largest_component(f->frame_point(p) - exact), 1e-16);
  const glm::dvec4 by_matrix = f->frame_from_world() * glm::dvec4(p, 1);
  EXPECT_GT(kernels::largest_component(glm::dvec3(by_matrix) - exact), 1e-6)
      << "the inverse matrix alone cancels";
}

TEST(VectorFrame, RefusesAxesInAPlaneOrNearlySo) {
  const auto rows = test::points({{1, 1, 1}});
  const auto code = [&](const Json& params) {
    return test::run_error(nodes::vector_frame(), params, {{rows}}).first;
  };
  EXPECT_EQ(code({{"c", {1, 1, 0}}}), "singular_frame");
  EXPECT_EQ(code({{"c", {1, 1, 1e-14}}}), "singular_frame");
  EXPECT_EQ(code({{"c", {1, 1, 1e-14}}, {"least_rcond", 1e-15}}), "");
  EXPECT_EQ(code({{"c", {0, 0, 1e-200}}}), "") << "short is not flat";
}

TEST(VectorFrame, GoesToTheFrame) {
  const auto out = test::run_node(nodes::vector_frame(),
                                  {{"origin", {1, 1, 1}}, {"a", {2, 0, 0}}, {"direction", "to_frame"}},
                                  {{test::points({{5, 1, 1}})}});
  EXPECT_EQ(out.at(0).as<Points>()->at.at(0), glm::dvec3(2, 0, 0));
}

}  // namespace
}  // namespace frustum
