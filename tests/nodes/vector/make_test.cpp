#include "nodes/vector/make.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

TEST(VectorMake, TellsPointsFromVectorsByTheirLastCoordinate) {
  const auto out = test::run_node(nodes::vector_make(), {{"points", {{1, 2, 3}}}, {"vectors", {{4, 5, 6}}}});
  const auto table = [&](std::size_t i) {
    return out.at(i).type().table(out.at(i).data(), 0, 10)["rows"][0];
  };
  EXPECT_EQ(table(0), (Json{1.0, 2.0, 3.0, 1}));
  EXPECT_EQ(table(1), (Json{4.0, 5.0, 6.0, 0}));
}

TEST(VectorMake, StepsFromTheIndexAndNotBySums) {
  const auto rows = vector::rows_of({{0, 0, 0}}, 1000, {0.1, 0, 0});
  ASSERT_EQ(rows.size(), 1001u);
  EXPECT_EQ(rows.back().x, 100);
  double sum = 0;
  for (int i = 0; i < 1000; ++i) sum += 0.1;
  EXPECT_NE(sum, 100);
  EXPECT_TRUE(vector::rows_of({}, 5, {1, 0, 0}).empty());
}

}  // namespace
}  // namespace frustum
