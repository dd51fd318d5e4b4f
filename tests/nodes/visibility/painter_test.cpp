#include "nodes/visibility/painter.h"

#include <gtest/gtest.h>

#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/value.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

using test::counter;

// A small face before a large slanted one, whose nearest corner is nearer and whose middle is as well.
test::ScreenMeshMaker<float> slanted_and_small() {
  test::ScreenMeshMaker<float> m;
  const auto a = m.vertex(0, 0, -1), b = m.vertex(90, 0, 0.5), c = m.vertex(0, 60, -1);
  m.face.emplace_back(a, b, c);
  const auto d = m.vertex(60, 2, -0.2), e = m.vertex(70, 2, -0.2), f = m.vertex(60, 10, -0.2);
  m.face.emplace_back(d, e, f);
  return m;
}

TEST(VisibilityPainter, OneDepthOfEachFaceIsNotEnough) {
  const Buffer mesh = test::buffer_of(slanted_and_small().make(test::scene_size));
  const auto first = [&](const char* key) {
    const auto out = test::run_node(nodes::visibility_painter(), {{"key", key}}, {{mesh}});
    return out.at(0).as<PaintOrder>()->pieces.at(0).face;
  };
  EXPECT_EQ(first("overlap"), 0U);  // the small face lies before the large one
  EXPECT_EQ(first("farthest"), 0U);
  EXPECT_EQ(first("middle"), 1U);  // both of these are wrong
  EXPECT_EQ(first("nearest"), 1U);
}

TEST(VisibilityPainter, FindsTheCycleAndWarns) {
  Context ctx;
  const Buffer mesh = test::buffer_of(test::three_bars<float>().make(test::scene_size));
  const auto out = test::run_node(nodes::visibility_painter(), Json::object(), {{mesh}}, &ctx);
  EXPECT_EQ(counter(ctx, "cycles"), 1U);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "cyclic_overlap");
  EXPECT_EQ(out.at(1).as<Table>()->rows(), 6U);
  // The order of whole faces is wrong somewhere: order decides, not depths.
  const Raster want = test::shown(nodes::rasterize_triangles(), {{mesh}, {}}, Precision::single);
  const Raster got = test::shown(nodes::visibility_paint(), {{out.at(0)}, {mesh}, {}}, Precision::single);
  EXPECT_GT(test::differences(want, got), 20);
}

template <class R>
void expect_right_without_cycles(Precision precision) {
  test::Random random(42);
  int without = 0, wrong_with = 0;
  for (int round = 0; round < 60; ++round) {
    const auto kind = round % 2 == 0 ? test::Soup::small : test::Soup::spheres;
    const Buffer mesh = test::screen_buffer(test::soup<R>(random, kind, 25), random, round % 4 == 1, true);
    Context ctx = test::with_precision(precision);
    const auto order = test::run_node(nodes::visibility_painter(), Json::object(), {{mesh}}, &ctx).at(0);
    const Raster want = test::shown(nodes::rasterize_triangles(), {{mesh}, {}}, precision);
    const int differ =
        test::differences(want, test::shown(nodes::visibility_paint(), {{order}, {mesh}, {}}, precision));
    if (counter(ctx, "cycles") == 0) {
      ++without;
      ASSERT_EQ(differ, 0) << round;
    } else {
      wrong_with += differ > 0;
    }
  }
  EXPECT_GT(without, 10);
  EXPECT_GT(wrong_with, 0);
}

TEST(VisibilityPainter, ShowsTheDepthBuffersPictureWhereThereIsNoCycle) {
  expect_right_without_cycles<float>(Precision::single);
  expect_right_without_cycles<double>(Precision::real_double);
}

TEST(VisibilityPainter, AnEmptyMeshHasAnEmptyOrder) {
  const Buffer mesh = test::buffer_of(test::ScreenMeshMaker<float>().make(test::scene_size));
  const auto out = test::run_node(nodes::visibility_painter(), Json::object(), {{mesh}});
  EXPECT_TRUE(out.at(0).as<PaintOrder>()->pieces.empty());
  EXPECT_EQ(out.at(1).as<Table>()->rows(), 0U);
}

}  // namespace
}  // namespace frustum
