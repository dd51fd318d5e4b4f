#include "nodes/vector/affine.h"

#include "nodes/kernels/vector.h"
#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

using kernels::Summation;

// Weights that add up to 1 but for rounding.
std::vector<double> weights(std::mt19937_64& random, std::size_t n) {
  std::uniform_real_distribution<double> in(-1, 2);
  std::vector<double> a(n);
  double sum = 0;
  for (std::size_t i = 0; i + 1 < n; ++i) sum += a[i] = in(random);
  a[n - 1] = 1 - sum;
  return a;
}

TEST(VectorAffine, GivesBackAPointThatAllOfThemAre) {
  std::mt19937_64 random(2);
  int drifted = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const glm::dvec3 p = test::random_row(random, 1e7);
    const auto a = weights(random, 3 + static_cast<std::size_t>(trial));
    const std::vector<glm::dvec3> all(a.size(), p);
    EXPECT_EQ(kernels::affine_combination(a, all, Summation::exact), p);
    EXPECT_EQ(kernels::affine_combination(a, all, Summation::compensated), p);
    drifted += kernels::affine_combination(a, all, Summation::plain) != p ? 1 : 0;
  }
  EXPECT_GT(drifted, 100) << "a plain sum drifts";
}

TEST(VectorAffine, CommutesWithTranslations) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const auto a = weights(random, 6);
    std::vector<glm::dvec3> p, moved;
    for (int i = 0; i < 6; ++i) {
      p.push_back(glm::dvec3(glm::ivec3(test::random_row(random, 1000))) / 16.0);
      moved.push_back(p.back() + glm::dvec3(0x1p23));
    }
    const glm::dvec3 here = kernels::affine_combination(a, p, Summation::exact);
    const glm::dvec3 there = kernels::affine_combination(a, moved, Summation::exact) - glm::dvec3(0x1p23);
    // The result near 2^23 has an ulp of 2^-29, of which rounding takes half.
    EXPECT_LE(kernels::largest_component(there - here), 0x1p-30 + 0x1p-44);
  }
}

TEST(VectorAffine, RefusesWeightsOfAnotherSumAndReportsWhatRoundingLeaves) {
  const auto p = test::points({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(test::run_error(nodes::vector_affine(), {{"weights", {{0.5, 0.5, 0.1}}}}, {{p}}).first,
            "not_affine");
  EXPECT_EQ(test::run_error(nodes::vector_affine(), {{"weights", {Json::array()}}}, {{p}}).first,
            "not_affine");
  const auto out =
      test::run_node(nodes::vector_affine(), {{"weights", {{0.7, 0.2, 0.1}, {2, -0.5, -0.5}}}}, {{p}});
  const auto drift = out.at(1).as<Table>()->columns.at(1).numbers;
  EXPECT_NE(drift[0], 0) << "0.7 + 0.2 + 0.1 is not 1 in binary";
  EXPECT_LT(std::fabs(drift[0]), 0x1p-52);
  EXPECT_EQ(drift[1], 0);
  EXPECT_EQ(out.at(0).as<Points>()->at[1], glm::dvec3(-0.5, -0.5, 0));
}

TEST(VectorAffine, WantsAWeightForEveryPoint) {
  EXPECT_EQ(test::run_error(nodes::vector_affine(), {{"weights", {{1}}}}, {{test::points({})}}).first,
            "rows_differ");
}

}  // namespace
}  // namespace frustum
