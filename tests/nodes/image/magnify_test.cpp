#include "nodes/image/magnify.h"

#include "nodes/image.h"
#include "runtime/buffers/image.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<Image> ramp(Rect window) {
  Raster raster(Frame{.window = window,
                      .planes = {{"R", PlaneKind::f32}, {"A", PlaneKind::f32}, {"id", PlaneKind::u32}}});
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x) {
      raster.view().row<float>(0, 0, y)[x - window.x0] = static_cast<float>(10 * y + x);
      raster.view().row<std::uint32_t>(2, 0, y)[x - window.x0] = static_cast<std::uint32_t>(100 + 10 * y + x);
    }
  return std::make_shared<const Image>(Image{std::move(raster)});
}

TEST(ImageMagnify, RepeatsEveryPixelInASquareWhateverTheTiles) {
  const Rect window{-2, -1, 5, 4};
  for (const int tile : {0, 1, 5, 8}) {
    const auto out =
        test::run_node(nodes::image_magnify(), {{"factor", 3}}, {{ramp(window)}}, nullptr, {}, tile);
    const Raster& raster = out.at(0).as<Image>()->raster;
    ASSERT_EQ(raster.frame().window, (Rect{-6, -3, 15, 12}));
    for (int y = -3; y < 12; ++y)
      for (int x = -6; x < 15; ++x) {
        const int sx = (x + 6) / 3 - 2, sy = (y + 3) / 3 - 1;
        ASSERT_EQ(raster.value(0, 0, x, y), 10 * sy + sx);
        ASSERT_EQ(raster.value(2, 0, x, y),
                  static_cast<double>(static_cast<std::uint32_t>(100 + 10 * sy + sx)));
      }
  }
}

TEST(ImageMagnify, DrawsItsGridOverColourAlone) {
  const auto out =
      test::run_node(nodes::image_magnify(), {{"factor", 4}, {"grid", {0.5, 0, 0}}}, {{ramp({0, 0, 2, 2})}});
  const Raster& raster = out.at(0).as<Image>()->raster;
  EXPECT_EQ(raster.value(0, 0, 4, 2), 0.5);
  EXPECT_EQ(raster.value(1, 0, 4, 2), 1) << "lines are opaque";
  EXPECT_EQ(raster.value(1, 0, 5, 2), 0);
  EXPECT_EQ(raster.value(0, 0, 5, 2), 1);
  EXPECT_EQ(raster.value(2, 0, 4, 4), 111) << "numbers stay";
}

TEST(ImageMagnify, RefusesWhatWouldBeTooLarge) {
  EXPECT_EQ(test::run_error(nodes::image_magnify(), {{"factor", 256}}, {{ramp({0, 0, 300, 2})}}).first,
            "too_large");
}

}  // namespace
}  // namespace frustum
