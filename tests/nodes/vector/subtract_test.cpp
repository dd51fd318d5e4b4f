#include "nodes/vector/subtract.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

TEST(VectorSubtract, TakesPointsFromPoints) {
  const auto p = test::points({{1, 2, 3}, {4, 4, 4}}), q = test::points({{1, 1, 1}});
  const auto out = test::run_node(nodes::vector_subtract(), Json::object(), {{p}, {q}});
  EXPECT_THAT(out.at(0).as<Vectors>()->along, testing::ElementsAre(glm::dvec3(0, 1, 2), glm::dvec3(3, 3, 3)));
  const auto none = test::run_node(nodes::vector_subtract(), Json::object(), {{p}, {p}});
  EXPECT_THAT(none.at(0).as<Vectors>()->along, testing::Each(glm::dvec3(0)));
}

TEST(VectorSubtract, GivesTheWayFromOneToTheOther) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const glm::dvec3 p(glm::ivec3(test::random_row(random, 1e6))),
        q(glm::ivec3(test::random_row(random, 1e6)));
    const std::vector<glm::dvec3> a{p}, b{q};
    EXPECT_EQ(q + vector::differences(a, b)[0], p);
  }
}

TEST(VectorSubtract, WantsAsManyOrOne) {
  const auto two = test::points({{1, 2, 3}, {4, 4, 4}});
  const auto three = test::points({{1, 2, 3}, {4, 4, 4}, {0, 0, 0}});
  EXPECT_EQ(test::run_error(nodes::vector_subtract(), Json::object(), {{three}, {two}}).first, "rows_differ");
  EXPECT_EQ(test::run_node(nodes::vector_subtract(), Json::object(), {{test::points({})}, {test::points({})}})
                .at(0)
                .as<Vectors>()
                ->along.size(),
            0u);
}

}  // namespace
}  // namespace frustum
