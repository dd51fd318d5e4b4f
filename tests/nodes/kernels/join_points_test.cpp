#include "nodes/kernels/join_points.h"

#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace frustum::kernels {
namespace {

using Points = std::vector<glm::vec3>;
using Numbers = std::vector<std::uint32_t>;

Numbers joined(const Points& p, double tolerance) {
  return joined_points<float>(std::span<const glm::vec3>(p), tolerance);
}

TEST(JoinPoints, GivesEqualPointsTheNumberOfTheFirst) {
  EXPECT_EQ(joined({{1, 2, 3}, {0, 0, 0}, {1, 2, 3}, {-0.0F, 0, -0.0F}, {1, 2, 4}}, 0),
            (Numbers{0, 1, 0, 1, 4}));
}

TEST(JoinPoints, LeavesWhatIsNotFiniteAlone) {
  const float nan = std::nanf(""), inf = INFINITY;
  for (const double tolerance : {0.0, 1e-3})
    EXPECT_EQ(
        joined({{nan, 0, 0}, {nan, 0, 0}, {inf, 0, 0}, {inf, 0, 0}, {0, 0, 0}, {0, 0, 0}}, tolerance).back(),
        4U);
  EXPECT_EQ(joined({{nan, 0, 0}, {nan, 0, 0}}, 0), (Numbers{0, 1}));
  EXPECT_EQ(joined({{nan, 0, 0}, {nan, 0, 0}}, 1), (Numbers{0, 1}));
}

// A chain of steps of 0.6 joins in pairs and never collapses: 0-1, 2-3, ...
TEST(JoinPoints, NeverJoinsPointsFurtherApartThanTheTolerance) {
  Points chain;
  for (int i = 0; i < 100; ++i) chain.emplace_back(0.6F * static_cast<float>(i), 0, 0);
  const Numbers first = joined(chain, 1);
  for (std::uint32_t i = 0; i < 100; ++i) EXPECT_EQ(first[i], i - i % 2);
}

// Against every pair: the earliest representative within the tolerance, in clusters, across cube borders,
// far from the origin.
TEST(JoinPoints, AgreesWithTryingEveryPair) {
  test::Random random(3);
  for (const double offset : {0.0, 1e4, -3e5}) {
    Points p;
    for (int i = 0; i < 600; ++i)
      p.emplace_back(static_cast<float>(offset + random.uniform(0, 4)),
                     static_cast<float>(random.uniform(-2, 2)), static_cast<float>(random.uniform(0, 1)));
    for (const double tolerance : {1e-9, 0.05, 0.3, 1.0, 20.0}) {
      Numbers want;
      for (std::uint32_t i = 0; i < p.size(); ++i) {
        std::uint32_t least = i;
        for (std::uint32_t j = 0; j < i && least == i; ++j)
          if (want[j] == j && norm(glm::dvec3(p[i]) - glm::dvec3(p[j])) <= tolerance) least = j;
        want.push_back(least);
      }
      EXPECT_EQ(joined(p, tolerance), want) << offset << " " << tolerance;
    }
  }
}

// 200000 points in one place, or all in one cube of the tolerance: quadratic time would take minutes.
TEST(JoinPoints, IsLinearWhereAllPointsMeet) {
  test::Random random(4);
  Points p;
  for (int i = 0; i < 200000; ++i)
    p.emplace_back(static_cast<float>(random.uniform()), static_cast<float>(random.uniform()),
                   static_cast<float>(random.uniform()));
  std::size_t representatives = 0;
  const Numbers first = joined(p, 1);
  for (std::uint32_t i = 0; i < first.size(); ++i) representatives += first[i] == i ? 1U : 0U;
  EXPECT_LE(representatives, 8U);
}

}  // namespace
}  // namespace frustum::kernels
