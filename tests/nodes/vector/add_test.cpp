#include "nodes/vector/add.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

TEST(VectorAdd, MovesPointsByVectors) {
  const auto p = test::points({{1, 2, 3}, {4, 4, 4}});
  const auto one =
      test::run_node(nodes::vector_add(), {{"scale", 0.5}}, {{p}, {test::vectors({{2, 0, -2}})}});
  EXPECT_THAT(one.at(0).as<Points>()->at, testing::ElementsAre(glm::dvec3(2, 2, 2), glm::dvec3(5, 4, 3)));
  const auto each =
      test::run_node(nodes::vector_add(), Json::object(), {{p}, {test::vectors({{1, 0, 0}, {0, 1, 0}})}});
  EXPECT_THAT(each.at(0).as<Points>()->at, testing::ElementsAre(glm::dvec3(2, 2, 3), glm::dvec3(4, 5, 4)));
}

TEST(VectorAdd, UndoesItselfWithTheOppositeScale) {
  const std::vector<glm::dvec3> p{{1, 2, 3}}, v{{0.5, -8, 1024}};
  EXPECT_EQ(vector::moved(vector::moved(p, v, 1), v, -1), p);
}

TEST(VectorAdd, WantsAsManyOrOne) {
  const auto p = test::points({{1, 2, 3}, {4, 4, 4}});
  EXPECT_EQ(test::run_error(nodes::vector_add(), Json::object(), {{p}, {test::vectors({})}}).first,
            "rows_differ");
}

}  // namespace
}  // namespace frustum
