#include "nodes/visibility/spans.h"

#include <gtest/gtest.h>

#include "runtime/buffers/value.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

// Two faces that cross at column 40 of every line.
Buffer crossing() {
  test::ScreenMeshMaker<float> m;
  const auto a = m.vertex(0, 0, 0), b = m.vertex(80, 0, 0.8), c = m.vertex(0, 60, 0);
  const auto d = m.vertex(0, 0, 0.8), e = m.vertex(80, 0, 0), f = m.vertex(0, 60, 0.8);
  m.face = {{a, b, c}, {d, e, f}};
  return test::buffer_of(m.make(test::scene_size));
}

TEST(VisibilitySpans, ShowsALineSpanBySpan) {
  Context ctx;
  const auto table =
      test::run_node(nodes::visibility_spans(), {{"line", 0}}, {{crossing()}, {}}, &ctx).at(0).as<Table>();
  ASSERT_EQ(table->rows(), 1U);  // both begin and end together
  EXPECT_EQ(table->columns[1].numbers[0], 0);
  EXPECT_EQ(table->columns[2].numbers[0], 79);
  EXPECT_EQ(table->columns[3].numbers[0], 2);
  EXPECT_EQ(table->columns[4].numbers[0], 0);
  EXPECT_GT(table->columns[5].numbers[0], 2);
  EXPECT_EQ(test::counter(ctx, "lines"), 64U);
  // A crossing is found by halving: about log2(80) times a line that has both.
  EXPECT_GT(test::counter(ctx, "halvings"), 30U);
  EXPECT_LT(test::counter(ctx, "halvings"), 64U * 10);
}

TEST(VisibilitySpans, ALineOutsideThePictureIsRefused) {
  EXPECT_EQ(test::run_error(nodes::visibility_spans(), {{"line", 64}}, {{crossing()}, {}}).first,
            "outside_window");
}

}  // namespace
}  // namespace frustum
