// texture.noise: the published noise, what a pixel does to it, and the node.
#include "nodes/texture/noise.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace frustum {
namespace {

using kernels::gradient_noise;

TEST(GradientNoise, IsThePublishedOne) {
  // Of Perlin's reference code in Java.
  EXPECT_EQ(gradient_noise(3.14, 42.0, 7.0), 0.13691995878400012);
  auto order = kernels::noise_permutation;
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i) << "every number once";
}

TEST(GradientNoise, IsZeroAtEveryLatticePointAndHasItsPeriod) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> in(0, 256);
  for (int z = -3; z < 3; ++z)
    for (int y = -20; y < 20; ++y)
      for (int x = 0; x < 300; x += 7) EXPECT_EQ(gradient_noise<double>(x, y, z), 0);
  for (int i = 0; i < 1000; ++i) {
    // Places on a grid of 2^-20, so that moving them by a period rounds nothing.
    const auto place = [&] { return std::floor(in(random)*0x1p20) * 0x1p-20; };
    const double x = place(), y = place(), z = place(), n = gradient_noise(x, y, z);
    EXPECT_EQ(gradient_noise(x + 256, y - 512, z + 768), n);
    EXPECT_LE(std::abs(n), 1.04);
  }
  for (const double wild : {double{INFINITY}, -double{INFINITY}, double{NAN}, 1e300, -1e300})
    EXPECT_LE(std::abs(gradient_noise(wild, 0.5, 0.25)), 1.04) << wild;
}

// The slope at a lattice point is its direction to an edge's middle, from either side; so is the change of
// the slope small across the lattice's planes, which with the first fade curve, 3 t^2 - 2 t^3, it is not.
TEST(GradientNoise, IsTwiceDifferentiableAcrossTheLattice) {
  constexpr double h = 1e-4;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> in(0, 1);
  std::uniform_int_distribution<int> cell(0, 255);
  const auto second = [&](double x, double y, double z) {  // of what lies to one side: x, x + h, x + 2 h
    return (gradient_noise(x + 2 * h, y, z) - 2 * gradient_noise(x + h, y, z) + gradient_noise(x, y, z)) /
           (h * h);
  };
  double largest_inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = cell(random), y = cell(random) + in(random), z = cell(random) + in(random);
    const double left = (gradient_noise(x, y, z) - gradient_noise(x - h, y, z)) / h,
                 right = (gradient_noise(x + h, y, z) - gradient_noise(x, y, z)) / h;
    EXPECT_NEAR(left, right, 40 * h * h) << "the slope: third derivatives reach some 60";
    EXPECT_NEAR(second(x - 2 * h, y, z), second(x, y, z), 0.1) << "the curvature";
    largest_inside = std::max(largest_inside, std::abs(second(x + in(random), y, z)));
  }
  EXPECT_GT(largest_inside, 5) << "there is a curvature to speak of";
}

TEST(OctaveSum, AddsOctavesOfHalfTheHeightAndTwiceTheFrequency) {
  const kernels::Octaves three{3, 2, 0.5, false};
  const double x = 0.3, y = 1.7, z = -2.2;
  const double want = (gradient_noise(x, y, z) + gradient_noise(2 * x, 2 * y, 2 * z) / 2 +
                       gradient_noise(4 * x, 4 * y, 4 * z) / 4) /
                      1.75;
  EXPECT_NEAR(kernels::octave_sum(three, {x, y, z}, 0.0), want, 1e-15);
}

TEST(OctaveSum, LeavesTheMeanWhereAPixelResolvesNothing) {
  EXPECT_EQ(kernels::octave_sum({6, 2, 0.5, false}, {0.3, 0.2, 0.1}, 5.0), 0);
  EXPECT_NEAR(kernels::octave_sum({6, 2, 0.5, true}, {0.3, 0.2, 0.1}, 5.0), kernels::mean_of_turbulence,
              1e-15);
  EXPECT_EQ(kernels::octave_sum({6, 2, 0.5, false}, {0.3, 0.2, 0.1}, double{NAN}), 0);
  double sum = 0;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> in(0, 256);
  constexpr int n = 200000;
  for (int i = 0; i < n; ++i) sum += std::abs(gradient_noise(in(random), in(random), in(random)));
  EXPECT_NEAR(sum / n, kernels::mean_of_turbulence, 0.005);
}

// Pixels of growing width on a plane through the noise: what fades is closer to the average over the pixel
// than what aliases.
TEST(OctaveSum, IsCloserToThePixelsAverageThanTheAliasedSum) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> in(0, 256);
  for (const bool turbulent : {false, true})
    for (const double width : {0.1, 0.3, 1.0, 3.0}) {
      const kernels::Octaves octaves{6, 2, 0.6, turbulent};
      double faded = 0, aliased = 0, mean = 0;
      for (int i = 0; i < 300; ++i) {
        const double x = in(random), y = in(random), z = in(random);
        double truth = 0;
        constexpr int k = 16;
        for (int a = 0; a < k; ++a)
          for (int b = 0; b < k; ++b)
            truth +=
                kernels::octave_sum(
                    octaves, {x + width * ((a + 0.5) / k - 0.5), y + width * ((b + 0.5) / k - 0.5), z}, 0.0) /
                (k * k);
        const double f = kernels::octave_sum(octaves, {x, y, z}, width) - truth,
                     a = kernels::octave_sum(octaves, {x, y, z}, 0.0) - truth;
        faded += f * f, aliased += a * a, mean += f / 300;
      }
      EXPECT_LT(faded, 0.5 * aliased) << width << (turbulent ? " turbulent" : "");
      EXPECT_LT(std::abs(mean), 0.02) << "no darker, no lighter";
    }
}

// ----- the node

Ref<Image> world_points() {
  Frame f{.window = {-2, 3, 17, 14}, .planes = {{"id", PlaneKind::u32}}};
  for (const char* name :
       {"P.x", "P.y", "P.z", "P.dx_dx", "P.dy_dx", "P.dz_dx", "P.dx_dy", "P.dy_dy", "P.dz_dy"})
    f.planes.push_back({name});
  Raster r(f);
  for (int y = 3; y < 14; ++y)
    for (int x = -2; x < 17; ++x) {
      r.view().row<std::uint32_t>(0, 0, y)[x + 2] = (x + y) % 4 == 0 ? no_face : 7;
      const float at[9] = {
          0.11F * static_cast<float>(x), 0.07F * static_cast<float>(y), 0.5F, 0.11F, 0, 0, 0, 0.07F, 0};
      for (int k = 0; k < 9; ++k) r.view().row<float>(k + 1, 0, y)[x + 2] = at[k];
    }
  return std::make_shared<Image>(Image{r});
}

TEST(TextureNoise, KeepsTheLawOfTilesAndCoversWhatIsSeen) {
  for (const char* params : {"{}", R"({"form": "turbulent", "bounded": false, "low": [1, 0, 0]})"}) {
    const test::PixelRun run(nodes::texture_noise(), params, {{"points", {world_points()}}});
    EXPECT_EQ(test::break_of_tile_law(run), "");
    const Raster image = run.whole();
    for (int x = -2; x < 17; ++x) EXPECT_EQ(image.at<float>(3, 0, x, 5), (x + 5) % 4 == 0 ? 0.0F : 1.0F);
  }
}

TEST(TextureNoise, MixesItsColoursByTheSum) {
  const Raster image =
      test::PixelRun(nodes::texture_noise(),
                     R"({"scale": 2, "octaves": 1, "contrast": 1, "bounded": false, "high": [2, 1, 0]})",
                     {{"points", {world_points()}}}, Precision::real_double)
          .whole();
  const double x = double{0.11F * 6}, y = double{0.07F * 7}, n = gradient_noise(2 * x, 2 * y, 1.0);
  EXPECT_NEAR(image.at<double>(0, 0, 6, 7), 2 * (0.5 + 0.5 * n), 1e-12);
  EXPECT_EQ(image.at<double>(2, 0, 6, 7), 0);
}

TEST(TextureNoise, AsksForThePlanesOfItsDomain) {
  try {
    test::PixelRun(nodes::texture_noise(), R"({"domain": "uv"})", {{"points", {world_points()}}});
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "missing_plane");
  }
}

}  // namespace
}  // namespace frustum
