#include "nodes/visibility/zbuffer.h"

#include <gtest/gtest.h>

#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

using zbuffer::Format;
using zbuffer::kept;

TEST(VisibilityZbuffer, WithRealsHasTheBytesOfRasterizeTriangles) {
  for (const int tile : {0, 7}) {
    const auto show = [&](const Buffer& mesh, const Buffer& pattern, Precision precision) {
      return test::shown(nodes::visibility_zbuffer(), {{mesh}, {pattern}}, precision, tile,
                         {{"format", "real"}});
    };
    test::expect_depth_buffer<float>(Precision::single, 3, show);
    test::expect_depth_buffer<double>(Precision::real_double, 3, show);
  }
}

// Hard case ZBF-10: monotone, 1 stays 1, nothing wraps.
TEST(VisibilityZbuffer, KeepsOrderAndEndsInEveryFormat) {
  test::Random random(46);
  for (const Format format : {Format::unorm16, Format::unorm24, Format::unorm32, Format::float32})
    for (const double low : {-1.0, 0.0}) {
      EXPECT_EQ(kept(format, 1, low), 1);
      EXPECT_EQ(kept(format, low, low), low);
      EXPECT_EQ(kept(format, std::nextafter(1.0, 0.0), low), 1);
      if (format != Format::float32) {
        EXPECT_EQ(kept(format, std::nextafter(1.0, 2.0), low), 1);
        EXPECT_EQ(kept(format, NAN, low), low);
      }
      for (int i = 0; i < 1000; ++i) {
        const double a = random.uniform(low, 1), b = a + std::exp2(random.uniform(-40, -10));
        ASSERT_LE(kept(format, a, low), kept(format, b, low));
        ASSERT_EQ(kept(format, kept(format, a, low), low), kept(format, a, low));
      }
    }
  EXPECT_EQ(kept(Format::unorm16, 0.25 / 65535, 0), 0);
  EXPECT_EQ(kept(Format::unorm16, 0.75 / 65535, 0), 1.0 / 65535);
}

// Row 41: depth after the divide is linear on the screen, so both ways give the same but for rounding.
TEST(VisibilityZbuffer, PlaneAndEdgesAgreeWithinRounding) {
  test::Random random(47);
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const double u = precision == Precision::single ? 0x1p-24 : 0x1p-53;
    const auto m = test::soup<double>(random, test::Soup::any, 40);
    test::ScreenMeshMaker<double> gentle = m;  // slopes of less than 2 a face's extent
    for (auto& p : gentle.position) p.z *= 0.25;
    const Buffer mesh = precision == Precision::single ? test::buffer_of([&] {
      test::ScreenMeshMaker<float> f;
      for (const auto& p : gentle.position) f.vertex(p.x, p.y, p.z);
      f.face = gentle.face;
      return f.make(test::scene_size);
    }())
                                                       : test::buffer_of(gentle.make(test::scene_size));
    const auto shown = [&](const char* how) {
      return test::shown(nodes::visibility_zbuffer(), {{mesh}, {}}, precision, 0,
                         {{"format", "real"}, {"interpolation", how}});
    };
    const Raster plane = shown("plane"), edges = shown("edges");
    int same = 0;
    double worst = 0;
    for (int y = 0; y < test::scene_size.y; ++y)
      for (int x = 0; x < test::scene_size.x; ++x)
        if (plane.at<std::uint32_t>(0, 0, x, y) == edges.at<std::uint32_t>(0, 0, x, y)) {
          ++same;
          worst = std::max(worst, std::fabs(plane.value(1, 0, x, y) - edges.value(1, 0, x, y)));
        }
    EXPECT_GT(same, test::scene_size.x * test::scene_size.y * 99 / 100);
    // Slivers amplify rounding by their aspect: some 2^12 of 96 px over 2^-6 px.
    EXPECT_LT(worst, u * 0x1p14);
    EXPECT_GT(worst, 0);
  }
}

// Two walls 0.2 % apart at the far end of a room from 0.001 to 1000: 24 bits make one of them, 32 do not.
TEST(VisibilityZbuffer, FewBitsCannotTellFarWallsApart) {
  const auto depth = [](double w) { return (1000.001 - 2 * 0.001 * 1000 / w) / 999.999; };
  test::ScreenMeshMaker<double> m;
  for (const double w : {501.0, 500.0}) {
    const auto a = m.vertex(0, 0, depth(w)), b = m.vertex(180, 0, depth(w)), c = m.vertex(0, 130, depth(w));
    m.face.emplace_back(a, b, c);
  }
  const Buffer mesh = test::buffer_of(m.make(test::scene_size));
  const auto seen = [&](const char* format) {
    return test::shown(nodes::visibility_zbuffer(), {{mesh}, {}}, Precision::real_double, 0,
                       {{"format", format}})
        .at<std::uint32_t>(0, 0, 5, 5);
  };
  EXPECT_EQ(seen("unorm16"), 0U);  // a tie, which the farther wall wins as the lower source
  EXPECT_EQ(seen("unorm24"), 0U);
  EXPECT_EQ(seen("unorm32"), 1U);
  EXPECT_EQ(seen("real"), 1U);
}

}  // namespace
}  // namespace frustum
