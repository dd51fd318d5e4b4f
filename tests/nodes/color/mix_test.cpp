#include "nodes/color/mix.h"

#include "nodes/color.h"
#include "tests/support/color_picture.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

using test::color_at, test::color_row;

Raster mix(const char* params, const Ref<Image>& a, const Ref<Image>& b) {
  return test::PixelRun(nodes::color_mix(), params, {{"image", {a}}, {"with", {b}}}).whole();
}

constexpr std::array<std::array<float, 4>, 8> corners{{{0, 0, 0, 1},
                                                       {1, 0, 0, 1},
                                                       {0, 1, 0, 1},
                                                       {1, 1, 0, 1},
                                                       {0, 0, 1, 1},
                                                       {1, 0, 1, 1},
                                                       {0, 1, 1, 1},
                                                       {1, 1, 1, 1}}};

// Row 104's oracle: over all pairs of corners lamps are the union of their parts, inks the intersection.
TEST(Mix, OverlapsAreThoseOfTheTables) {
  std::vector<std::array<float, 4>> a, b;
  for (const auto& p : corners)
    for (const auto& q : corners) a.push_back(p), b.push_back(q);
  const auto left = color_row<float>(a, Alpha::premultiplied, ""),
             right = color_row<float>(b, Alpha::premultiplied, "");
  const Raster light = mix(R"({"model": "additive"})", left, right),
               ink = mix(R"({"model": "subtractive"})", left, right);
  for (int i = 0; i < 64; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = static_cast<std::size_t>(i);
      const bool p = a[at][k] != 0, q = b[at][k] != 0;
      EXPECT_EQ(std::min(color_at(light, i)[k], 1.0), p || q ? 1 : 0) << i;
      EXPECT_EQ(color_at(ink, i)[k], p && q ? 1 : 0) << i;
    }
  EXPECT_EQ(color_at(light, 1 * 8 + 2), (std::array<double, 3>{1, 1, 0})) << "red and green light: yellow";
  EXPECT_EQ(color_at(ink, 6 * 8 + 3), (std::array<double, 3>{0, 1, 0})) << "cyan and yellow ink: green";
}

TEST(Mix, WhatCoversNothingChangesNothing) {
  const auto a = color_row<float>({{0.25F, 0.5F, 0, 0.5F}, {0.5F, 0.25F, 1, 1}, {0, 0, 0, 0}},
                                  Alpha::premultiplied, ""),
             none = color_row<float>({{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}, Alpha::premultiplied, "");
  for (const char* params : {R"({"model": "additive"})", R"({"model": "subtractive"})"})
    for (const bool swapped : {false, true}) {
      const Raster out = swapped ? mix(params, none, a) : mix(params, a, none);
      for (int x = 0; x < 3; ++x) {
        EXPECT_EQ(color_at(out, x), color_at(a->raster, x)) << params;
        EXPECT_EQ(out.value(3, 0, x, 0), a->raster.value(3, 0, x, 0)) << params;
      }
    }
}

TEST(Mix, WeighsByCoverage) {
  const auto a = color_row<float>({{0.5F, 0, 0, 0.5F}}, Alpha::premultiplied, ""),
             b = color_row<float>({{1, 1, 0, 1}}, Alpha::premultiplied, "");
  // Half a red filter over yellow: half yellow, half red.
  EXPECT_EQ(color_at(mix(R"({"model": "subtractive"})", a, b), 0), (std::array<double, 3>{1, 0.5, 0}));
  EXPECT_EQ(color_at(mix(R"({"model": "additive"})", a, b), 0), (std::array<double, 3>{1.5, 1, 0}));
  EXPECT_EQ(mix(R"({"model": "additive"})", a, b).value(3, 0, 0, 0), 1);
  EXPECT_EQ(mix(R"({"model": "additive"})", a, a).value(3, 0, 0, 0), 1);
}

TEST(Mix, RefusesWhatDoesNotMatch) {
  const auto error = [](const Ref<Image>& a, const Ref<Image>& b) {
    return test::color_error(nodes::color_mix(), "{}", {{"image", {a}}, {"with", {b}}});
  };
  const auto one = color_row<float>({{0, 0, 0, 1}}, Alpha::premultiplied, "");
  EXPECT_EQ(error(one, color_row<float>({{0, 0, 0, 1}, {0, 0, 0, 1}}, Alpha::premultiplied, "")),
            "frames_differ");
  EXPECT_EQ(error(one, color_row<float>({{0, 0, 0, 1}}, Alpha::premultiplied, "lin_rec2020")),
            "spaces_differ");
  EXPECT_EQ(error(one, color_row<float>({{0, 0, 0, 1}}, Alpha::straight, "")), "straight_alpha");
}

TEST(Mix, KeepsTheLawOfTiles) {
  for (const char* params : {R"({"model": "additive"})", R"({"model": "subtractive"})"})
    EXPECT_EQ(test::break_of_tile_law(
                  {nodes::color_mix(),
                   params,
                   {{"image", {test::random_colors<float>()}}, {"with", {test::random_colors<float>()}}}}),
              "");
}

}  // namespace
}  // namespace frustum
