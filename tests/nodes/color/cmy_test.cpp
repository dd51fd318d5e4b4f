#include "nodes/color/cmy.h"

#include "nodes/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using Rgb = std::array<float, 3>;

// Row 104's oracle: what lamps have, inks leave.
TEST(Cmy, ComplementsTheCornersOfTheCube) {
  for (int corner = 0; corner < 8; ++corner) {
    const Rgb rgb{static_cast<float>(corner & 1), static_cast<float>(corner >> 1 & 1),
                  static_cast<float>(corner >> 2)};
    const Rgb opposite{1 - rgb[0], 1 - rgb[1], 1 - rgb[2]};
    EXPECT_EQ(color::complement(rgb), opposite);
    EXPECT_EQ(color::complement(color::complement(rgb)), rgb);
    const auto ink = color::cmyk_of_rgb(rgb);
    EXPECT_EQ(color::rgb_of_cmyk(ink), rgb);
    EXPECT_EQ(ink[3], corner == 0 ? 1 : 0);
  }
}

TEST(Cmy, IsItsOwnInverse) {
  for (int i = -4096; i <= 8192; ++i) {
    const float v = static_cast<float>(i) * 0x1p-12F;
    ASSERT_EQ(color::complement(color::complement<float>({v, v, v})), (Rgb{v, v, v}));
  }
  for (int i = 0; i < 256; ++i) {
    const float v = static_cast<float>(i) / 255;
    ASSERT_NEAR((color::complement(color::complement<float>({v, v, v}))[0]), v, 0x1p-24);
  }
}

// Hard case COL-12: black, and one unit beside it.
TEST(Cmy, BlackInkComesBack) {
  test::Random random(3);
  for (int i = 0; i < 100000; ++i) {
    Rgb rgb;
    for (float& v : rgb)
      v = static_cast<float>(i < 1000 ? std::ldexp(random.uniform(), -i / 7) : random.uniform());
    const auto ink = color::cmyk_of_rgb(rgb);
    for (const float v : ink) ASSERT_TRUE(v >= 0 && v <= 1) << i;
    const Rgb back = color::rgb_of_cmyk(ink);
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(back[k], rgb[k], 4 * 0x1p-24) << i;
  }
  EXPECT_EQ(color::cmyk_of_rgb<float>({0, 0, 0}), (std::array<float, 4>{0, 0, 0, 1}));
  EXPECT_EQ(color::cmyk_of_rgb<float>({-1, -1, 0}), (std::array<float, 4>{0, 0, 0, 1}));
  const float tiny = std::numeric_limits<float>::denorm_min();
  EXPECT_EQ(color::cmyk_of_rgb<float>({tiny, 0, 0}), (std::array<float, 4>{0, 1, 1, 1}));
  EXPECT_EQ((color::rgb_of_cmyk(color::cmyk_of_rgb<float>({2, 0.5F, -1}))), (Rgb{2, 0.5F, -1}));
  for (const float v : color::cmyk_of_rgb<float>({1, std::nanf(""), 1})) EXPECT_TRUE(std::isnan(v));
}

TEST(Cmy, PassesCoverageThereAndBack) {
  const auto in = test::color_row<float>({{0.5F, 0.25F, 0, 0.5F}, {0, 0, 0, 0}, {1, 0.5F, 0.25F, 1}},
                                         Alpha::premultiplied, "lin_rec709");
  for (const bool black : {false, true}) {
    const std::string also = black ? R"("black": true)" : R"("black": false)";
    const Raster inks = test::color_run(nodes::color_cmy(), "{" + also + "}", in).whole();
    EXPECT_EQ(inks.frame().planes.size(), black ? 5u : 4u);
    EXPECT_EQ(test::color_at(inks, 0), (std::array<double, 3>{0, 0.5, 1}));
    const Raster back = test::color_run(nodes::color_cmy(), R"({"way": "to_rgb", )" + also + "}",
                                        std::make_shared<const Image>(Image{inks}))
                            .whole();
    EXPECT_EQ(test::first_difference(back, in->raster), "") << also;
  }
}

TEST(Cmy, KeepsTheLawOfTiles) {
  for (const char* params : {"{}", R"({"black": true})"})
    EXPECT_EQ(
        test::break_of_tile_law(test::color_run(nodes::color_cmy(), params, test::random_colors<float>())),
        "");
}

}  // namespace
}  // namespace frustum
