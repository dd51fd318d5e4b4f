#include "nodes/visibility/paint.h"

#include <gtest/gtest.h>

#include "runtime/buffers/paint_order.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

std::shared_ptr<PaintOrder> order_of(std::vector<std::uint32_t> faces, std::uint32_t of) {
  auto order = std::make_shared<PaintOrder>();
  order->faces = of;
  for (const std::uint32_t f : faces) order->pieces.push_back({f, 0, 0});
  return order;
}

// Two squares, the second farther away, that overlap in columns 4 to 7.
test::ScreenMeshMaker<float> two_steps() {
  test::ScreenMeshMaker<float> m;
  for (int k = 0; k < 2; ++k) {
    const double x = 4.0 * k, z = 0.25 + 0.5 * k;
    const auto a = m.vertex(x, 0, z), b = m.vertex(x + 8, 0, z), c = m.vertex(x, 30, z);
    m.face.emplace_back(a, b, c);
  }
  return m;
}

TEST(VisibilityPaint, OrderDecidesAndNotDepth) {
  const Buffer mesh = test::buffer_of(two_steps().make({16, 4}));
  const auto seen = [&](std::vector<std::uint32_t> faces, const Json& params, bool front_to_back = false) {
    auto order = order_of(std::move(faces), 2);
    order->front_to_back = front_to_back;
    const Raster r = test::shown(nodes::visibility_paint(), {{test::buffer_of(order)}, {mesh}, {}},
                                 Precision::single, 0, params);
    return std::array{r.at<std::uint32_t>(0, 0, 1, 0), r.at<std::uint32_t>(0, 0, 5, 0),
                      r.at<std::uint32_t>(0, 0, 9, 0), r.at<std::uint32_t>(0, 0, 14, 0)};
  };
  const auto all = Json::object();
  EXPECT_EQ(seen({1, 0}, all), (std::array<std::uint32_t, 4>{0, 0, 1, no_face}));
  EXPECT_EQ(seen({0, 1}, all), (std::array<std::uint32_t, 4>{0, 1, 1, no_face}));  // wrong, as it was told
  EXPECT_EQ(seen({0, 1}, all, true), (std::array<std::uint32_t, 4>{0, 0, 1, no_face}));
  EXPECT_EQ(seen({1, 0}, {{"first", 1}}), (std::array<std::uint32_t, 4>{no_face, 1, 1, no_face}));
  EXPECT_EQ(seen({1, 0}, {{"first", 0}}), (std::array<std::uint32_t, 4>{no_face, no_face, no_face, no_face}));
}

TEST(VisibilityPaint, PiecesShareOutTheSamplesOfTheirFace) {
  const auto m = test::three_bars<float>();
  const Buffer mesh = test::buffer_of(m.make(test::scene_size));
  auto order = order_of({}, 6);
  order->cuts = {{kernels::Cut::Kind::plane, true, 2},
                 {kernels::Cut::Kind::plane, false, 2},
                 {kernels::Cut::Kind::column, true, 40},
                 {kernels::Cut::Kind::column, false, 40}};
  const auto covered = [&](std::vector<kernels::OrderedPiece> pieces) {
    order->pieces = std::move(pieces);
    const Raster r = test::shown(
        nodes::visibility_paint(),
        {{test::buffer_of(std::make_shared<PaintOrder>(*order))}, {mesh}, {test::scene_pattern()}},
        Precision::single);
    int n = 0;
    for (int s = 0; s < 2; ++s)
      for (int y = 0; y < test::scene_size.y; ++y)
        for (int x = 0; x < test::scene_size.x; ++x) n += r.at<std::uint32_t>(0, s, x, y) == 0;
    return n;
  };
  const int whole = covered({{0, 0, 0}}), near = covered({{0, 0, 1}}), far = covered({{0, 1, 1}});
  EXPECT_EQ(near + far, whole);
  EXPECT_GT(std::min(near, far), 0);
  EXPECT_EQ(covered({{0, 0, 1}, {0, 1, 1}}), whole);
  EXPECT_EQ(covered({{0, 2, 1}}) + covered({{0, 3, 1}}), whole);
}

TEST(VisibilityPaint, TilesAndTheWholeHaveTheSameBytes) {
  test::Random random(45);
  const Buffer mesh = test::screen_buffer(test::soup<float>(random, test::Soup::any, 60), random, true, true);
  const Buffer order = test::run_node(nodes::visibility_bsp(), Json::object(), {{mesh}}).at(0);
  const test::NodeInputs in{{order}, {mesh}, {test::scene_pattern()}};
  const Raster whole = test::shown(nodes::visibility_paint(), in, Precision::single);
  for (const int edge : {1, 7, 32})
    EXPECT_EQ(test::differences(whole, test::shown(nodes::visibility_paint(), in, Precision::single, edge)),
              0);
}

TEST(VisibilityPaint, AnOrderOfAnotherMeshIsRefused) {
  const Buffer mesh = test::buffer_of(two_steps().make({16, 4}));
  EXPECT_EQ(test::run_error(nodes::visibility_paint(), Json::object(),
                            {{test::buffer_of(order_of({0}, 3))}, {mesh}, {}})
                .first,
            "wrong_mesh");
}

}  // namespace
}  // namespace frustum
