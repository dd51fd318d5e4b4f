#include "nodes/kernels/box_triangles.h"

#include <gtest/gtest.h>

#include "nodes/kernels/simd/box_triangles.h"
#include "tests/nodes/kernels/screen_scene.h"
#include "tests/support/simd_targets.h"

namespace frustum {
namespace {

using kernels::BoxCounts;
using kernels::BoxedTriangle;
using kernels::PixelRect;

TEST(BoxTriangles, BoxesThePixelsWhoseSamplesMayBeCovered) {
  test::ScreenScene<double> s;
  s.triangle({10.25, 20.5, 0}, {12.75, 20.5, 0}, {11, 23.25, 0});
  BoxedTriangle out{};
  BoxCounts counts;
  const kernels::SampleBox centre{2048, 2048, 2048, 2048}, anywhere{0, 0, 4095, 4095};
  const PixelRect window{-5, 7, 100, 100};
  kernels::box_triangle(s.view(), 0, centre, window, &out, counts);
  EXPECT_EQ(counts.boxed, 1U);  // centres 10.5 to 12.5 and 20.5 to 22.5
  EXPECT_EQ((std::array{out.x0, out.y0, out.x1, out.y1}), (std::array<std::uint16_t, 4>{15, 13, 17, 15}));
  counts = {};
  kernels::box_triangle(s.view(), 0, anywhere, window, &out, counts);
  EXPECT_EQ((std::array{out.x0, out.y0, out.x1, out.y1}), (std::array<std::uint16_t, 4>{15, 13, 17, 16}));
}

class BoxTrianglesSimd : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, BoxTrianglesSimd, test::every_target(), test::target_name);

TEST_P(BoxTrianglesSimd, HasTheBoxesOfItsTwin) {
  test::Random random(51);
  const double bad[] = {NAN, INFINITY, -INFINITY, 2097153, -1e30, 1e38};
  // Sizes below, at and beyond the legs that lanes take; places below, at and beyond the coordinates they
  // take.
  for (const double size : {0.2, 3.0, 127.99, 128.0, 200.0, 1e5, 2e6})
    for (const double place : {0.0, 60000.0, 131071.5, 131072.0, 2e6})
      for (const bool troubled : {false, true}) {
        test::ScreenScene<float> s;
        s.corner_bits = 4 + static_cast<int>(random.below(5));
        for (int i = 0; i < 203; ++i) {
          const auto coordinate = [&](double at) {
            return std::min(2097152.0, std::max(-2097152.0, at + random.uniform(-size, size)));
          };
          const double x = random.uniform(-place, place), y = random.uniform(-place, place);
          const auto corner = [&] { return std::array{coordinate(x), coordinate(y), random.uniform()}; };
          auto a = corner(), b = corner(), c = corner();
          if (troubled && random.below(16) == 0) a[random.below(3)] = bad[random.below(6)];
          if (random.below(8) == 0)
            c = {2 * b[0] - a[0], 2 * b[1] - a[1], 0};  // on a line, if the grid has it
          s.triangle(a, b, c);
          if (troubled && random.below(32) == 0)
            s.position.back().w = static_cast<float>(bad[random.below(3)]);
        }
        for (const kernels::SampleBox samples :
             {kernels::SampleBox{2048, 2048, 2048, 2048}, {0, 17, 4095, 4000}}) {
          const PixelRect window{-100, -50, 60000, 65000};
          std::vector<BoxedTriangle> want(203), got(203);
          const BoxCounts n = kernels::box_triangles(s.view(), 1, 203, samples, window, want.data());
          const BoxCounts m = kernels::simd::box_triangles(s.view(), 1, 203, samples, window, got.data());
          ASSERT_EQ(m.boxed, n.boxed) << size << " " << place;
          EXPECT_EQ(m.out_of_range, n.out_of_range);
          EXPECT_EQ(m.without_area, n.without_area);
          EXPECT_EQ(std::memcmp(got.data(), want.data(), n.boxed * sizeof(BoxedTriangle)), 0)
              << size << " " << place;
        }
      }
}

}  // namespace
}  // namespace frustum
