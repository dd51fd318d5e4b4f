#include "nodes/color/luminance.h"

#include "nodes/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using test::color_at, test::color_row, test::color_run;

TEST(Luminance, WeighsPrimariesAsTheStandardsSay) {
  // ITU-R BT.709-6 and BT.2020-2 print these to four digits.
  struct Case {
    const char* space;
    std::array<double, 3> weights;
  };
  for (const Case& c : {Case{"lin_rec709", {0.2126, 0.7152, 0.0722}},
                        {"srgb", {0.2126, 0.7152, 0.0722}},
                        {"lin_rec2020", {0.2627, 0.6780, 0.0593}},
                        {"xyz_d65", {0, 1, 0}}}) {
    const auto in =
        color_row<double>({{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}}, Alpha::none, c.space);
    const Raster y = color_run(nodes::color_luminance(), "{}", in, Precision::real_double).whole(0);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(y.value(0, 0, k, 0), c.weights[static_cast<std::size_t>(k)], 5.1e-5) << c.space;
    EXPECT_NEAR(y.value(0, 0, 3, 0), 1, 4e-15) << c.space;
  }
}

// Encoded values are no light: half of the code is a fifth of the light.
TEST(Luminance, DecodesFirst) {
  const auto in = color_row<double>({{0.5, 0.5, 0.5, 1}}, Alpha::none, "srgb");
  EXPECT_NEAR(
      color_run(nodes::color_luminance(), "{}", in, Precision::real_double).whole(0).value(0, 0, 0, 0),
      std::pow((0.5 + 0.055) / 1.055, 2.4), 1e-15);
}

TEST(Luminance, GreyIsAsBright) {
  const auto in = color_row<float>({{0.25F, 0.5F, 0.125F, 0.5F}, {0, 0, 0, 0}, {-1, 2, 4, 1}},
                                   Alpha::premultiplied, "lin_rec2020");
  const auto run = color_run(nodes::color_luminance(), "{}", in);
  const auto grey = std::make_shared<const Image>(Image{run.whole(1)});
  EXPECT_EQ(grey->raster.frame().color_space, "lin_rec709");
  EXPECT_EQ(grey->raster.frame().alpha, Alpha::premultiplied);
  const Raster once = run.whole(0), twice = color_run(nodes::color_luminance(), "{}", grey).whole(0);
  for (int x = 0; x < 3; ++x) {
    EXPECT_NEAR(twice.value(0, 0, x, 0), once.value(0, 0, x, 0), 1e-6);
    EXPECT_EQ(grey->raster.value(3, 0, x, 0), in->raster.value(3, 0, x, 0));
  }
  EXPECT_EQ(once.value(0, 0, 1, 0), 0);
}

TEST(Luminance, KeepsTheLawOfTiles) {
  EXPECT_EQ(test::break_of_tile_law(color_run(nodes::color_luminance(), "{}", test::random_colors<float>())),
            "");
}

}  // namespace
}  // namespace frustum
