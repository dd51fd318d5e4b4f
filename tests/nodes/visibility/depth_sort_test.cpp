#include "nodes/visibility/depth_sort.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/value.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

using test::counter;

TEST(VisibilityDepthSort, ShowsTheDepthBuffersPicture) {
  const auto show = [](const Buffer& mesh, const Buffer& pattern, Precision precision) {
    return test::painted(nodes::visibility_depth_sort(), Json::object(), mesh, pattern, precision);
  };
  test::expect_depth_buffer<float>(Precision::single, 6, show);
  test::expect_depth_buffer<double>(Precision::real_double, 6, show);
}

TEST(VisibilityDepthSort, OpensACycleByASplitAndSaysSo) {
  Context ctx;
  const Buffer mesh = test::buffer_of(test::three_bars<float>().make(test::scene_size));
  const auto out = test::run_node(nodes::visibility_depth_sort(), Json::object(), {{mesh}}, &ctx);
  EXPECT_GE(counter(ctx, "splits"), 1U);
  EXPECT_TRUE(ctx.warnings().empty());
  const Raster want = test::shown(nodes::rasterize_triangles(), {{mesh}, {}}, Precision::single);
  const Raster got = test::shown(nodes::visibility_paint(), {{out.at(0)}, {mesh}, {}}, Precision::single);
  EXPECT_EQ(test::differences(want, got), 0);
  const auto& events = out.at(1).as<Table>()->columns.at(3).texts;
  EXPECT_THAT(events, testing::Contains("the first is split by the plane of the second"));
  EXPECT_EQ(events.back(), "painted");
}

// The face that reaches farthest lies before the other where they overlap.
TEST(VisibilityDepthSort, ExchangesTwoFacesInTheWrongOrder) {
  test::ScreenMeshMaker<float> m;
  const auto a = m.vertex(0, 0, -0.9), b = m.vertex(90, 0, 0.9), c = m.vertex(0, 60, -0.9);
  const auto d = m.vertex(0, 2, 0.5), e = m.vertex(20, 2, 0.5), f = m.vertex(0, 20, 0.5);
  m.face = {{a, b, c}, {d, e, f}};
  Context ctx;
  const Buffer mesh = test::buffer_of(m.make(test::scene_size));
  const auto out = test::run_node(nodes::visibility_depth_sort(), Json::object(), {{mesh}}, &ctx);
  EXPECT_EQ(counter(ctx, "exchanges"), 1U);
  EXPECT_EQ(counter(ctx, "splits"), 0U);
  EXPECT_EQ(out.at(0).as<PaintOrder>()->pieces.at(0).face, 1U);
  EXPECT_EQ(out.at(1).as<Table>()->columns.at(3).texts.at(0), "exchanged: the second is tried first");
}

TEST(VisibilityDepthSort, CutsTwoFacesThatPierceOneAnotherOnce) {
  test::ScreenMeshMaker<float> m;
  const auto a = m.vertex(10, 10, 0), b = m.vertex(80, 10, 1), c = m.vertex(10, 50, 0);
  const auto d = m.vertex(10, 10, 1), e = m.vertex(80, 10, 0), f = m.vertex(10, 50, 1);
  m.face = {{a, b, c}, {d, e, f}};
  Context ctx;
  const Buffer mesh = test::buffer_of(m.make(test::scene_size));
  const auto out = test::run_node(nodes::visibility_depth_sort(), Json::object(), {{mesh}}, &ctx);
  EXPECT_EQ(counter(ctx, "splits"), 1U);
  EXPECT_EQ(out.at(0).as<PaintOrder>()->pieces.size(), 3U);
}

// Hard case DST-03: corners on each other's planes are no reason to cut.
TEST(VisibilityDepthSort, NeverSplitsAConvexSolid) {
  test::Random random(43);
  for (int round = 0; round < 20; ++round) {
    test::ScreenMeshMaker<float> m;
    test::add_ball(m, random);
    Context ctx;
    const Buffer mesh = test::buffer_of(m.make(test::scene_size));
    test::run_node(nodes::visibility_depth_sort(), Json::object(), {{mesh}}, &ctx);
    EXPECT_EQ(counter(ctx, "splits"), 0U);
  }
}

TEST(VisibilityDepthSort, KeepsAsManyStepsAsAsked) {
  const Buffer mesh = test::buffer_of(test::three_bars<float>().make(test::scene_size));
  const auto out = test::run_node(nodes::visibility_depth_sort(), {{"rows", 2}}, {{mesh}});
  EXPECT_EQ(out.at(1).as<Table>()->rows(), 2U);
}

}  // namespace
}  // namespace frustum
