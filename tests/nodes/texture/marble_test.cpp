// texture.marble: the sine and its average over a pixel, and the node.
#include "nodes/texture/marble.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace frustum {
namespace {

// One point.
double mix_at(const texture::Marble& m, bool bounded, std::array<double, 3> at, std::array<double, 3> by_x,
              std::array<double, 3> by_y) {
  kernels::PlaceRows<double> rows;
  for (std::size_t k = 0; k < 3; ++k) rows.at[k] = &at[k], rows.by_x[k] = &by_x[k], rows.by_y[k] = &by_y[k];
  double mix = -1;
  texture::marble_row(m, bounded, rows, 1, &mix);
  return mix;
}

TEST(TextureMarble, IsASineAcrossItsLayers) {
  const texture::Marble straight{{1, 0, 0}, 2, 0, {1, 2, 0.5, true}};
  for (const double x : {0.0, 0.05, 0.125, 0.4, -0.3, 1000.1})
    EXPECT_NEAR(mix_at(straight, false, {x, 0.3, 0.9}, {}, {}),
                0.5 + 0.5 * std::sin(4 * std::numbers::pi * x), 1e-11);
  const texture::Marble bent{{0, 1, 0}, 1, 3, {2, 2, 0.5, true}};
  const double t = kernels::octave_sum(bent.octaves, {0.2, 0.4, 0.6}, 0.0);
  EXPECT_NEAR(mix_at(bent, false, {0.2, 0.4, 0.6}, {}, {}),
              0.5 + 0.5 * std::sin(2 * std::numbers::pi * (0.4 + 3 * t)), 1e-12);
}

// Straight layers have an average in closed form; here it is summed.
TEST(TextureMarble, AveragesStraightLayersOverThePixel) {
  const texture::Marble straight{{1, 0.5, 0}, 3, 0, {1, 2, 0.5, true}};
  for (const double size : {0.01, 0.1, 0.4, 2.0}) {
    const std::array<double, 3> by_x{size, 0.2 * size, 0}, by_y{-0.3 * size, 0.7 * size, size};
    double mean = 0;
    constexpr int k = 400;
    for (int a = 0; a < k; ++a)
      for (int b = 0; b < k; ++b) {
        const double s = (a + 0.5) / k - 0.5, t = (b + 0.5) / k - 0.5;
        mean += mix_at(straight, false,
                       {0.37 + s * by_x[0] + t * by_y[0], 0.1 + s * by_x[1] + t * by_y[1], 0}, {}, {}) /
                (k * k);
      }
    EXPECT_NEAR(mix_at(straight, true, {0.37, 0.1, 0}, by_x, by_y), mean, 1e-4) << size;
  }
}

TEST(TextureMarble, KeepsTheLawOfTiles) {
  Frame f{.window = {0, 0, 19, 11}, .planes = {{"id", PlaneKind::u32}}};
  for (const char* name : {"uv.u", "uv.v", "uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy"})
    f.planes.push_back({name});
  Raster r(f);
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 19; ++x) {
      r.view().row<std::uint32_t>(0, 0, y)[x] = x % 5 == 4 ? no_face : 0;
      const float at[6] = {0.13F * static_cast<float>(x), 0.4F * static_cast<float>(y), 0.13F, 0, 0, 0.4F};
      for (int k = 0; k < 6; ++k) r.view().row<float>(k + 1, 0, y)[x] = at[k];
    }
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const test::PixelRun run(nodes::texture_marble(), R"({"domain": "uv"})",
                             {{"points", {Ref<Image>(std::make_shared<Image>(Image{r}))}}}, precision);
    EXPECT_EQ(test::break_of_tile_law(run), "");
    const Raster image = run.whole();
    for (int x = 0; x < 19; ++x) EXPECT_EQ(image.value(3, 0, x, 3), x % 5 == 4 ? 0 : 1);
  }
}

}  // namespace
}  // namespace frustum
