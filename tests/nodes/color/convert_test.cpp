#include "nodes/color/convert.h"

#include "nodes/color.h"
#include "runtime/buffers/image.h"
#include "runtime/core/error.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gmock/gmock.h>

#include <cmath>

namespace frustum {
namespace {

using testing::HasSubstr;

// Random colours, some outside [0, 1], with alpha in `alpha_plane`, depth and ids beside them.
template <class R>
Image picture(std::string space, Alpha alpha = Alpha::premultiplied, int samples = 1) {
  constexpr PlaneKind real = plane_kind_of<R>;
  std::shared_ptr<SamplePattern> pattern;
  if (samples > 1) {
    pattern = std::make_shared<SamplePattern>();
    pattern->samples = samples;
    pattern->x.assign(static_cast<std::size_t>(samples), 2048), pattern->y = pattern->x;
  }
  const Raster r(
      Frame{.window = {-5, 3, 32, 30},
            .pattern = pattern,
            .planes = {{"Z"}, {"R", real}, {"A", real}, {"B", real}, {"G", real}, {"id", PlaneKind::u32}},
            .color_space = std::move(space),
            .alpha = alpha});
  test::Random random(5);
  const Tile t = r.view();
  for (int s = 0; s < samples; ++s)
    for (int y = 3; y < 30; ++y)
      for (int x = 0; x < 37; ++x) {
        const double a = x % 5 == 0 ? 0 : x % 3 == 0 ? 1 : random.uniform(0.01, 1);
        for (int p = 0; p < 5; ++p) {
          const double v = p == 2 ? a : random.uniform(-0.1, 1.5) * (x % 5 == 0 ? 1 : a);
          if (p == 0)
            t.row<float>(p, s, y)[x] = static_cast<float>(v);
          else
            t.row<R>(p, s, y)[x] = static_cast<R>(v);
        }
        t.row<std::uint32_t>(5, s, y)[x] = static_cast<std::uint32_t>(random.bits());
      }
  return {r};
}

test::PixelRun convert(const Image& image, std::string_view params) {
  return {nodes::color_convert(), params, {{"image", {std::make_shared<const Image>(image)}}}};
}

double srgb(double v) {
  const double a = std::abs(v), e = a <= 0.0031308 ? 12.92 * a : 1.055 * std::pow(a, 1 / 2.4) - 0.055;
  return std::copysign(e, v);
}

TEST(Convert, EncodesColoursWithoutTheirAlphaAndPassesTheRest) {
  const Image in = picture<float>("lin_rec709");
  const Raster out = convert(in, R"({"to": "sRGB"})").whole();
  EXPECT_EQ(out.frame().color_space, "srgb");
  EXPECT_EQ(out.frame().planes, in.raster.frame().planes);
  for (int y = 3; y < 30; ++y)
    for (int x = -5; x < 32; ++x) {
      const double a = in.raster.value(2, 0, x, y);
      for (const int p : {1, 3, 4}) {
        const double v = in.raster.value(p, 0, x, y), want = a > 0 ? srgb(v / a) * a : srgb(v);
        ASSERT_NEAR(out.value(p, 0, x, y), want, 1e-6);
      }
      for (const int p : {0, 2, 5}) ASSERT_EQ(out.value(p, 0, x, y), in.raster.value(p, 0, x, y));
    }
}

TEST(Convert, StraightAlphaAndMatricesNeedNoDividing) {
  const Image straight = picture<float>("lin_rec709", Alpha::straight);
  EXPECT_NEAR(convert(straight, R"({"to": "srgb"})").whole().value(1, 0, 2, 5),
              srgb(straight.raster.value(1, 0, 2, 5)), 1e-6);
  const Image in = picture<float>("lin_rec709");
  const Raster out = convert(in, R"({"to": "lin_p3d65"})").whole();
  const double want = 0.82246197 * in.raster.value(1, 0, 2, 5) + 0.17753803 * in.raster.value(4, 0, 2, 5);
  EXPECT_NEAR(out.value(1, 0, 2, 5), want, 1e-6);
}

TEST(Convert, IdentityPassesEveryBit) {
  Image in = picture<float>("srgb");
  in.raster.view().row<float>(1, 0, 3)[0] = std::nanf("7");
  for (const char* params :
       {R"({"to": "srgb"})", R"({"to": "raw"})", R"({"to": "acescg", "from": "ACEScg"})"})
    EXPECT_EQ(test::first_difference(convert(in, params).whole(), in.raster), "") << params;
}

TEST(Convert, KeepsTheLawOfTiles) {
  for (const char* params :
       {R"({"to": "srgb"})", R"({"to": "rec2020"})", R"({"to": "srgb", "engine": "ocio"})"}) {
    EXPECT_EQ(test::break_of_tile_law(convert(picture<float>("lin_rec709", Alpha::premultiplied, 3), params)),
              "")
        << params;
    EXPECT_EQ(test::break_of_tile_law(convert(picture<double>("acescg"), params)), "") << params;
  }
}

TEST(Convert, HasTheSameBitsOnEverySimdTarget) {
  const Image in = picture<float>("acescg");
  const Raster whole = convert(in, R"({"to": "srgb"})").whole();
  test::for_each_simd_target([&](const char* name) {
    EXPECT_EQ(test::first_difference(convert(in, R"({"to": "srgb"})").whole(), whole), "") << name;
  });
}

TEST(Convert, DoublesKeepTheirDigits) {
  const Image in = picture<double>("srgb");
  const Raster out = convert(in, R"({"to": "lin_rec709"})").whole();
  const double v = in.raster.value(1, 0, 2, 5) / in.raster.value(2, 0, 2, 5);
  const double want =
      (std::abs(v) <= 0.04045 ? std::abs(v) / 12.92 : std::pow((std::abs(v) + 0.055) / 1.055, 2.4)) *
      in.raster.value(2, 0, 2, 5);
  EXPECT_NEAR(std::abs(out.value(1, 0, 2, 5)), want, 1e-15);
}

TEST(Convert, OpenColorIoGivesNearlyTheSame) {
  const Image in = picture<float>("acescg");
  const Raster ours = convert(in, R"({"to": "srgb"})").whole(),
               theirs = convert(in, R"({"to": "srgb", "engine": "ocio"})").whole();
  double worst = 0;
  for (int y = 3; y < 30; ++y)
    for (int x = -5; x < 32; ++x)
      for (const int p : {1, 3, 4})
        worst = std::max(worst, std::abs(ours.value(p, 0, x, y) - theirs.value(p, 0, x, y)));
  EXPECT_LT(worst, 2e-5);
  EXPECT_GT(worst, 0) << "two engines, not one";
}

TEST(Convert, StartsFromTheSpaceOfTheImageOrLinear) {
  const Image none = picture<float>(""), linear = picture<float>("lin_rec709"),
              acescg = picture<float>("acescg");
  EXPECT_EQ(test::first_difference(convert(none, "{}").whole(), convert(linear, "{}").whole()), "");
  EXPECT_EQ(
      test::first_difference(convert(linear, R"({"from": "acescg"})").whole(), convert(acescg, "{}").whole()),
      "");
}

TEST(Convert, NaNStaysWhereItIs) {
  const Image in = picture<float>("lin_rec709");
  in.raster.view().row<float>(4, 0, 10)[6] = std::nanf("");
  const Raster out = convert(in, R"({"to": "srgb"})").whole();
  EXPECT_TRUE(std::isnan(out.at<float>(4, 0, 1, 10)));
  EXPECT_FALSE(std::isnan(out.at<float>(1, 0, 1, 10))) << "the curve works on each channel";
}

std::pair<std::string, std::string> problem(const Image& image, std::string_view params) {
  try {
    convert(image, params);
  } catch (const NodeError& e) {
    return {e.code, e.what()};
  }
  return {};
}

TEST(Convert, SaysWhatItDoesNotKnow) {
  EXPECT_EQ(problem(picture<float>("lin_rec709"), R"({"to": "srbg"})").first, "unknown_color_space");
  EXPECT_THAT(problem(picture<float>("lin_rec709"), R"({"to": "acesgc"})").second,
              HasSubstr("did you mean 'acescg'?"));
  EXPECT_EQ(problem(picture<float>("house_log"), "{}").first, "unknown_color_space");
  const Image depth{Raster(Frame{.window = {0, 0, 2, 2}, .planes = {{"Z"}}})};
  EXPECT_EQ(problem(depth, "{}").first, "missing_plane");
  const Image ids{Raster(Frame{.window = {0, 0, 2, 2}, .planes = {{"R", PlaneKind::u32}, {"G"}, {"B"}}})};
  EXPECT_EQ(problem(ids, "{}").first, "wrong_plane_kind");
}

TEST(Convert, DividingByAlphaAndBackKeepsValues) {
  const double alpha[] = {0, 1, 0.3, std::nan(""), -1};
  double v[] = {0.5, 0.7, 0.2, 0.4, 0.6};
  divide_by_alpha(alpha, v, 5);
  EXPECT_DOUBLE_EQ(v[2], 0.2 / 0.3);
  multiply_by_alpha(alpha, v, 5);
  EXPECT_THAT(v, testing::ElementsAre(0.5, 0.7, testing::DoubleEq(0.2), 0.4, 0.6));
}

// ZBF-09: a colour over an alpha of 1e-45 is infinite in float.
TEST(Convert, CoverageBelowTheLeastIsNone) {
  const float alpha[] = {1e-45F, 0x1p-65F, 0x1p-64F};
  float v[] = {1, 2, 3};
  divide_by_alpha(alpha, v, 3);
  EXPECT_THAT(v, testing::ElementsAre(1, 2, 3 * 0x1p64F));
}

}  // namespace
}  // namespace frustum
