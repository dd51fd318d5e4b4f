#include "nodes/color/rgb_hsv.h"

#include "nodes/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using color::hsv_of_rgb, color::rgb_of_hsv;
template <class R>
using Rgb = std::array<R, 3>;

// Row 99's oracle: every colour of 8 bits comes back, each number to within 8 u of the greatest.
TEST(RgbHsv, EveryColourOfEightBitsComesBack) {
  double worst = 0;
  int wrong = 0, outside = 0;
  for (int code = 0; code < 1 << 24; ++code) {
    const std::array<int, 3> c{code >> 16, code >> 8 & 255, code & 255};
    const Rgb<float> rgb{static_cast<float>(c[0]) / 255, static_cast<float>(c[1]) / 255,
                         static_cast<float>(c[2]) / 255};
    const Rgb<float> hsv = hsv_of_rgb(rgb), back = rgb_of_hsv(hsv);
    const int most = std::max({c[0], c[1], c[2]});
    outside += !(hsv[0] >= 0 && hsv[0] < 360 && hsv[1] >= 0 && hsv[1] <= 1 &&
                 hsv[2] == static_cast<float>(most) / 255);
    for (std::size_t k = 0; k < 3; ++k) {
      wrong += static_cast<int>(std::floor(back[k] * 255 + 0.5F)) != c[k];
      worst = std::max(worst, std::abs(static_cast<double>(back[k]) - rgb[k]) * 255 / std::max(most, 1));
    }
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(outside, 0);
  EXPECT_LE(worst, 8 * 0x1p-24);
}

TEST(RgbHsv, KnowsTheCornersOfTheCube) {
  const auto expect = [](Rgb<double> rgb, Rgb<double> hsv) {
    EXPECT_EQ(hsv_of_rgb(rgb), hsv);
    EXPECT_EQ(rgb_of_hsv(hsv), rgb);
  };
  expect({1, 0, 0}, {0, 1, 1}), expect({1, 1, 0}, {60, 1, 1}), expect({0, 1, 0}, {120, 1, 1});
  expect({0, 1, 1}, {180, 1, 1}), expect({0, 0, 1}, {240, 1, 1}), expect({1, 0, 1}, {300, 1, 1});
  expect({0, 0, 0}, {0, 0, 0}), expect({1, 1, 1}, {0, 0, 1}), expect({0.5, 0.5, 0.5}, {0, 0, 0.5});
  expect({1, 0.5, 0.5}, {0, 0.5, 1}), expect({0.25, 0.5, 0.25}, {120, 0.5, 0.5});
}

// Hard case COL-05: colours outside of the cube.
template <class R>
void expect_round_trips(double u) {
  test::Random random(7);
  for (int i = 0; i < 200000; ++i) {
    Rgb<R> rgb;
    for (R& v : rgb) v = static_cast<R>(i % 2 == 0 ? random.magnitude(-6, 6) : random.uniform(-1, 3));
    const R most = std::max({rgb[0], rgb[1], rgb[2]});
    const R scale = std::max({std::abs(rgb[0]), std::abs(rgb[1]), std::abs(rgb[2])});
    if (std::abs(most) < scale * R(0x1p-10)) continue;
    const Rgb<R> back = rgb_of_hsv(hsv_of_rgb(rgb));
    for (std::size_t k = 0; k < 3; ++k) ASSERT_NEAR(back[k], rgb[k], 16 * u * scale) << i << " " << k;
  }
}
TEST(RgbHsv, NegativeAndBrightColoursComeBack) {
  expect_round_trips<float>(0x1p-24);
  expect_round_trips<double>(0x1p-53);
  EXPECT_EQ(hsv_of_rgb<double>({-0.5, 0, 1}), (Rgb<double>{220, 1.5, 1}));
  EXPECT_EQ(hsv_of_rgb<double>({2, -1, 0.5}), (Rgb<double>{330, 1.5, 2}));
  EXPECT_EQ(hsv_of_rgb<double>({-1, -2, -2}), (Rgb<double>{0, -1, -1}));
}

TEST(RgbHsv, SaysWhatHasNoSaturation) {
  EXPECT_TRUE(std::isinf(hsv_of_rgb<float>({0, -1, 0})[1]));
  const float nan = std::nanf("");
  for (const Rgb<float>& rgb : {Rgb<float>{nan, 1, 2}, {1, nan, 2}, {1, 2, nan}})
    for (const float v : hsv_of_rgb(rgb)) EXPECT_TRUE(std::isnan(v));
  for (const float v : rgb_of_hsv<float>({nan, 0.5F, 1})) EXPECT_TRUE(std::isnan(v));
}

// Hard case COL-06.
TEST(RgbHsv, HueGoesAround) {
  const float below = std::nextafter(360.F, 0.F);
  const Rgb<float> red{1, 0, 0};
  for (const float h : {0.F, 360.F, -360.F, 720.F, -1e-8F, 1e-8F, below, 3.6e6F})
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(rgb_of_hsv<float>({h, 1, 1})[k], red[k], 1e-6) << h;
  EXPECT_EQ(rgb_of_hsv<float>({-120, 1, 1}), (Rgb<float>{0, 0, 1}));
  EXPECT_EQ(rgb_of_hsv<float>({1e6F, 1, 1}), rgb_of_hsv<float>({280, 1, 1}));  // 1e6 = 2777 * 360 + 280
  const float h = hsv_of_rgb<float>({1, 0, 1e-9F})[0];
  EXPECT_GE(h, 0);
  EXPECT_LT(h, 360);
}

TEST(RgbHsv, PassesCoverageThereAndBack) {
  const auto in = test::color_row<float>(
      {{0.5F, 0.25F, 0.25F, 0.5F}, {0, 0, 0, 0}, {0.25F, 0.5F, 0, 0}, {1, 0.5F, 0.25F, 1}},
      Alpha::premultiplied, "srgb");
  const Raster hsv = test::color_run(nodes::color_rgb_hsv(), "{}", in).whole();
  EXPECT_EQ(hsv.frame().planes[0].name, "H");
  EXPECT_EQ(hsv.frame().color_space, "srgb");
  EXPECT_EQ(hsv.frame().alpha, Alpha::straight);
  EXPECT_EQ(test::color_at(hsv, 0), (std::array<double, 3>{0, 0.5, 1}));
  const Raster back = test::color_run(nodes::color_rgb_hsv(), R"({"way": "to_rgb"})",
                                      std::make_shared<const Image>(Image{hsv}))
                          .whole();
  EXPECT_EQ(back.frame().alpha, Alpha::premultiplied);
  EXPECT_EQ(test::first_difference(back, in->raster), "");
}

TEST(RgbHsv, IsNoPictureForOthers) {
  const auto hsv = test::color_row<float>({{0, 1, 1, 1}}, Alpha::straight, "srgb", {"H", "S", "V"});
  EXPECT_EQ(test::color_error(nodes::color_convert(), R"({"to": "lin_rec709"})", {{"image", {hsv}}}),
            "missing_plane");
  EXPECT_EQ(test::color_error(nodes::color_rgb_hsv(), "{}", {{"image", {hsv}}}), "missing_plane");
}

TEST(RgbHsv, KeepsTheLawOfTiles) {
  EXPECT_EQ(
      test::break_of_tile_law(test::color_run(nodes::color_rgb_hsv(), "{}", test::random_colors<float>())),
      "");
  EXPECT_EQ(test::break_of_tile_law(test::color_run(
                nodes::color_rgb_hsv(), R"({"way": "to_rgb"})",
                test::random_colors<double>(Alpha::straight, {"H", "S", "V"}), Precision::real_double)),
            "");
}

}  // namespace
}  // namespace frustum
