#include "nodes/image/mix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "nodes/image.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"

namespace frustum {
namespace {

TEST(ImageMix, TheEndsKeepTheirBitsWhateverTheOtherHolds) {
  const float nan = std::nanf("");
  const std::vector<float> a{0.1F, nan, 3, 1}, b{nan, 0.7F, 5, 2}, share{0, 1, 0.25F, 0.5F};
  std::vector<float> to(4);
  image::mix_row<float>(a.data(), b.data(), share.data(), 1, 4, to.data());
  EXPECT_EQ(to, (std::vector<float>{0.1F, 0.7F, 3.5F, 1.5F}));
  image::mix_row<float>(b.data() + 2, a.data() + 2, nullptr, 0.5F, 2, to.data());
  EXPECT_EQ(to[0], 4);
  EXPECT_EQ(to[1], 1.5F);
  image::mix_row<float>(a.data() + 2, b.data() + 2, share.data() + 2, 0.5F, 2, to.data());
  EXPECT_EQ(to[0], 3.25F) << "the amount scales the share";
}

Buffer picture(int width, std::vector<Plane> planes, float scale,
               std::string space = std::string(linear_rec709)) {
  Raster r({.window = {0, 0, width, 9},
            .planes = std::move(planes),
            .color_space = std::move(space),
            .alpha = Alpha::premultiplied});
  for (int p = 0; p < static_cast<int>(r.frame().planes.size()); ++p)
    for (int y = 0; y < 9; ++y)
      for (int x = 0; x < width; ++x)
        r.view().row<float>(p, 0, y)[x] = scale * static_cast<float>(p + 1 + x * y % 5);
  return Buffer(std::make_shared<const Image>(Image{std::move(r)}));
}
const std::vector<Plane> rgb{{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}},
    rgba{{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}, {"A", PlaneKind::f32}},
    y_alone{{"Y", PlaneKind::f32}};

TEST(ImageMix, KeepsTheLawOfTiles) {
  for (const Precision precision : {Precision::single, Precision::real_double})
    EXPECT_EQ(test::break_of_tile_law({nodes::image_mix(),
                                       R"({ "amount": 0.3 })",
                                       {{"image", {picture(21, rgba, 0.1F)}},
                                        {"other", {picture(21, rgb, 0.2F)}},
                                        {"share", {picture(21, y_alone, 0.05F)}}},
                                       precision}),
              "");
}

TEST(ImageMix, WhatHasNoAlphaIsOpaque) {
  const test::PixelRun run(nodes::image_mix(), R"({ "amount": 0.5 })",
                           {{"image", {picture(4, rgb, 0.1F)}}, {"other", {picture(4, rgba, 0.1F)}}});
  const Raster r = run.whole();
  ASSERT_EQ(r.frame().planes.size(), 4u);
  EXPECT_FLOAT_EQ(r.at<float>(3, 0, 0, 0), 0.7F) << "between 1 and 0.4";
  EXPECT_FLOAT_EQ(r.at<float>(0, 0, 1, 1), 0.2F);
}

std::string error_of(Buffer other) {
  try {
    test::PixelRun(nodes::image_mix(), "{}", {{"image", {picture(4, rgb, 1)}}, {"other", {std::move(other)}}})
        .whole();
  } catch (const NodeError& e) {
    return e.code;
  }
  return "";
}

TEST(ImageMix, PicturesThatDoNotGoTogetherAreRefused) {
  EXPECT_EQ(error_of(picture(5, rgb, 1)), "different_frames");
  EXPECT_EQ(error_of(picture(4, rgb, 1, "srgb_rec709_scene")), "colors_differ");
  EXPECT_EQ(error_of(picture(4, rgb, 1)), "");
}

}  // namespace
}  // namespace frustum
