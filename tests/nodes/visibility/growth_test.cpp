#include "nodes/visibility/growth.h"

#include <gtest/gtest.h>

#include "nodes/visibility.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <nlohmann/json.hpp>

namespace frustum {
namespace {

TEST(VisibilityGrowth, FitsAPowerLaw) {
  const std::vector<double> n{1, 2, 4, 8}, square{3, 12, 48, 192}, flat{5, 5, 5, 5};
  EXPECT_NEAR(growth::exponent(n, square), 2, 1e-12);
  EXPECT_NEAR(growth::exponent(n, flat), 0, 1e-12);
}

// Checklist row 46: methods of the image space work for samples, those of the object space for pairs of faces.
TEST(VisibilityGrowth, WorkOnSamplesGrowsSlowerThanWorkOnFaces) {
  const auto table =
      test::run_node(nodes::visibility_growth(), {{"faces", {64, 128, 256, 512}}, {"side", 128}})
          .at(0)
          .as<Table>();
  ASSERT_EQ(table->rows(), 5U);
  const auto& exponent = table->columns.back().numbers;
  EXPECT_NEAR(exponent[0], 0, 0.1);  // depth buffer: covered samples
  EXPECT_LT(exponent[1], 0.7);       // scanline: spans get shorter
  EXPECT_GT(exponent[2], 1.2);       // painter: pairs that overlap in y
  EXPECT_LT(exponent[2], 2);
  // Depth sort: pairs whose depths overlap, of which smaller faces have fewer; a tree: n log n and the splits.
  for (const std::size_t method : {3U, 4U}) {
    EXPECT_GT(exponent[method], exponent[1]);
    EXPECT_GT(exponent[method], 0.8);
    EXPECT_LT(exponent[method], 1.6);
  }
  EXPECT_EQ(test::run_error(nodes::visibility_growth(), {{"faces", {64, 64}}}).first, "bad_sizes");
}

}  // namespace
}  // namespace frustum
