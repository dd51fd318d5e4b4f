#include "nodes/color/xy.h"

#include "nodes/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using test::color_at, test::color_row, test::color_run;

// Row 102's oracle: white has the chromaticity of its standard, primaries theirs.
TEST(Xy, PrimariesAndWhiteAreThoseOfTheStandards) {
  struct Case {
    const char* space;
    std::array<double, 8> xy;
  };
  for (const Case& c : {Case{"lin_rec709", {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}},
                        {"srgb", {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290}},
                        {"lin_rec2020", {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290}},
                        {"display_p3", {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290}}}) {
    const auto in = color_row<double>(
        {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}, {0.5, 0, 0, 1}}, Alpha::none, c.space);
    const Raster out = color_run(nodes::color_xy(), "{}", in, Precision::real_double).whole();
    for (int i = 0; i < 4; ++i)
      for (std::size_t k = 0; k < 2; ++k)
        EXPECT_NEAR(color_at(out, i)[k], c.xy[2 * static_cast<std::size_t>(i) + k], 1e-14) << c.space << i;
    EXPECT_NEAR(color_at(out, 4)[0], c.xy[0], 1e-14) << "dimmer";
    EXPECT_NEAR(color_at(out, 0)[2] + color_at(out, 1)[2] + color_at(out, 2)[2], 1, 1e-14);
    EXPECT_NEAR(color_at(out, 3)[2], 1, 1e-14);
    EXPECT_EQ(out.frame().color_space, "xyz_d65");
  }
}

// Hard case COL-11.
TEST(Xy, BlackIsWhiteWithoutLight) {
  const float tiny = std::numeric_limits<float>::denorm_min();
  const auto in = color_row<float>({{0, 0, 0, 1}, {1, 0, -1, 1}, {tiny, tiny, tiny, 1}, {1, 1, 1, 1}},
                                   Alpha::none, "xyz_d65");
  const auto run = color_run(nodes::color_xy(), "{}", in);
  const Raster out = run.whole(0), defined = run.whole(1);
  for (const int x : {0, 1}) {
    EXPECT_EQ(color_at(out, x)[0], 0.3127F);
    EXPECT_EQ(color_at(out, x)[1], 0.3290F);
    EXPECT_EQ(color_at(out, x)[2], 0);
    EXPECT_EQ(defined.value(0, 0, x, 0), 0);
  }
  EXPECT_EQ(color_at(out, 2)[0], 1.F / 3);
  EXPECT_EQ(defined.value(0, 0, 2, 0), 1);
  const Raster back =
      color_run(nodes::color_xy(), R"({"way": "to_xyz"})", std::make_shared<const Image>(Image{out})).whole();
  EXPECT_EQ(color_at(back, 0), (std::array<double, 3>{0, 0, 0}));
}

TEST(Xy, ColoursComeBackFromXyy) {
  test::Random random(9);
  for (int i = 0; i < 100000; ++i) {
    std::array<float, 3> xyz;
    for (float& v : xyz) v = static_cast<float>(random.uniform(0.01, 10));
    const auto back = color::xyz_of_xyy(color::xyy_of_xyz<float>(xyz, {}));
    const float sum = xyz[0] + xyz[1] + xyz[2];
    ASSERT_EQ(back[1], xyz[1]);
    for (std::size_t k : {0, 2}) ASSERT_NEAR(back[k], xyz[k], 8 * 0x1p-24 * sum * (1 + xyz[k] / xyz[1]));
  }
}

TEST(Xy, KnowsNoSpaceOfAnother) {
  const auto in = color_row<float>({{0, 0, 0, 1}}, Alpha::none, "my_space");
  EXPECT_EQ(test::color_error(nodes::color_xy(), "{}", {{"image", {in}}}), "unknown_color_space");
}

TEST(Xy, KeepsTheLawOfTiles) {
  EXPECT_EQ(test::break_of_tile_law(color_run(nodes::color_xy(), "{}", test::random_colors<float>())), "");
}

}  // namespace
}  // namespace frustum
