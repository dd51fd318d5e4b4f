#include "nodes/vector/convex.h"

#include "nodes/kernels/predicates.h"
#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

std::vector<double> weights(std::mt19937_64& random, std::size_t n) {
  std::uniform_real_distribution<double> in(0, 1);
  std::vector<double> a(n);
  double sum = 0;
  for (double& x : a) sum += x = in(random);
  for (double& x : a) x /= sum;
  return a;
}

TEST(VectorConvex, StaysInTheTetrahedronByExactPredicates) {
  const std::vector<glm::dvec3> corner{{0, 0, 0}, {1000, 3, 1}, {2, 1001, 5}, {7, 11, 999}};
  std::mt19937_64 random(7);
  for (int trial = 0; trial < 2000; ++trial) {
    const glm::dvec3 p = vector::convex_combination(weights(random, 4), corner);
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& a = corner[(i + 1) % 4];
      const auto& b = corner[(i + 2) % 4];
      const auto& c = corner[(i + 3) % 4];
      EXPECT_EQ(kernels::orientation(a, b, c, p), kernels::orientation(a, b, c, corner[i])) << trial;
    }
  }
}

TEST(VectorConvex, NeverLeavesTheBoxOfItsPoints) {
  std::mt19937_64 random(8);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<glm::dvec3> p;
    for (int i = 0; i < 5; ++i) p.push_back(glm::dvec3(1e9) + test::random_row(random, 1e-6));
    const glm::dvec3 q = vector::convex_combination(weights(random, 5), p);
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      double low = p[0][axis], high = low;
      for (const auto& r : p) low = std::min(low, r[axis]), high = std::max(high, r[axis]);
      EXPECT_GE(q[axis], low);
      EXPECT_LE(q[axis], high);
    }
  }
}

TEST(VectorConvex, GivesACornerItsOwnBits) {
  const glm::dvec3 p(0.1, 1e300, -7e-5);
  EXPECT_EQ(vector::convex_combination(std::vector<double>{0, 1, 0},
                                       std::vector<glm::dvec3>{{1, 2, 3}, p, {4, 5, 6}}),
            p);
}

TEST(VectorConvex, TellsAnAffineCombinationFromAConvexOne) {
  const auto p = test::points({{0, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(test::run_error(nodes::vector_convex(), {{"weights", {{2, -1}}}}, {{p}}).first, "not_convex");
  EXPECT_EQ(test::run_error(nodes::vector_convex(), {{"weights", {{2, 1}}}}, {{p}}).first, "not_affine")
      << "errata E2: weights of at least 0 are not enough";
  EXPECT_EQ(test::run_error(nodes::vector_convex(), {{"weights", {{1}}}}, {{p}}).first, "rows_differ");
  EXPECT_EQ(
      test::run_node(nodes::vector_convex(), {{"weights", {{0.25, 0.75}}}}, {{p}}).at(0).as<Points>()->at[0],
      glm::dvec3(0.75, 0, 0));
}

}  // namespace
}  // namespace frustum
