// supersample.resolve: against a direct sum in double, closed forms of edges, and the vector kernels.
#include "nodes/kernels/resolve.h"
#include "nodes/kernels/simd/resolve.h"
#include "nodes/supersample.h"
#include "runtime/buffers/image.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>

namespace frustum {
namespace {

Ref<SamplePattern> random_pattern(int samples, int period, unsigned seed = 1) {
  test::Random random(seed);
  auto p = std::make_shared<SamplePattern>();
  p->samples = samples, p->period = period;
  p->x.clear(), p->y.clear();
  for (int i = 0; i < samples * period * period; ++i) {
    p->x.push_back(static_cast<std::uint16_t>(random.below(4096)));
    p->y.push_back(static_cast<std::uint16_t>(random.below(4096)));
  }
  return p;
}

// n x n samples in the middles of their cells.
Ref<SamplePattern> grid_pattern(int n) {
  auto p = std::make_shared<SamplePattern>();
  p->samples = n * n;
  p->x.clear(), p->y.clear();
  for (int i = 0; i < n * n; ++i) {
    p->x.push_back(static_cast<std::uint16_t>((2 * (i % n) + 1) * 2048 / n));
    p->y.push_back(static_cast<std::uint16_t>((2 * (i / n) + 1) * 2048 / n));
  }
  return p;
}

using Value = std::function<double(int plane, int sample, int x, int y)>;

Ref<Image> image(Rect window, Ref<SamplePattern> pattern, int planes, const Value& value,
                 PlaneKind kind = PlaneKind::f32) {
  Frame f{.window = window, .pattern = std::move(pattern), .planes = {}, .alpha = Alpha::premultiplied};
  for (int p = 0; p < planes; ++p) f.planes.push_back({"p" + std::to_string(p), kind});
  Raster r(f);
  for (int p = 0; p < planes; ++p)
    for (int s = 0; s < r.frame().samples(); ++s)
      for (int y = window.y0; y < window.y1; ++y)
        for (int x = window.x0; x < window.x1; ++x) {
          if (kind == PlaneKind::f64)
            r.view().row<double>(p, s, y)[x - window.x0] = value(p, s, x, y);
          else
            r.view().row<float>(p, s, y)[x - window.x0] = static_cast<float>(value(p, s, x, y));
        }
  return std::make_shared<Image>(Image{r});
}

// Noise in some places, equal samples in others.
Value patchy(unsigned seed) {
  auto random = std::make_shared<test::Random>(seed);
  return [random](int, int, int x, int y) {
    return (x / 9 + y / 7) % 3 == 0 ? random->uniform(-1, 1) : 0.1 * ((x / 9) % 2);
  };
}

Raster resolved(const Ref<Image>& in, std::string_view params, Precision precision = Precision::single) {
  return test::PixelRun(nodes::supersample_resolve(), params, {{"image", {in}}}, precision).whole();
}

// The direct sum over every sample of the picture, with the textbook form of Mitchell's filter.
double mitchell(double x) {
  x = std::abs(x);
  if (x < 1) return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
  if (x < 2) return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
  return 0;
}

TEST(SupersampleResolve, IsTheWeightedMeanOfTheSamplesAround) {
  for (const int period : {1, 4}) {
    const Rect w{-5, 3, 14, 19};
    const auto pattern = random_pattern(5, period);
    test::Random random(3);
    std::vector<double> noise(5 * 32 * 32);
    for (double& v : noise) v = random.uniform(-1, 1);
    const auto in = image(w, pattern, 1, [&](int, int s, int x, int y) {
      return noise[static_cast<std::size_t>((s * 32 + y) * 32 + x + 5)];
    });
    const Raster single = resolved(in, "{}"), exact = resolved(in, "{}", Precision::real_double);
    for (int y = w.y0; y < w.y1; ++y)
      for (int x = w.x0; x < w.x1; ++x) {
        double sum = 0, total = 0;
        for (int s = 0; s < 5; ++s)
          for (int v = w.y0; v < w.y1; ++v)
            for (int u = w.x0; u < w.x1; ++u) {
              const std::size_t i = pattern->index(s, u, v);
              const double weight = mitchell(u + pattern->x[i] / 4096.0 - x - 0.5) *
                                    mitchell(v + pattern->y[i] / 4096.0 - y - 0.5);
              sum += weight * in->raster.value(0, s, u, v), total += weight;
            }
        EXPECT_NEAR(exact.value(0, 0, x, y), sum / total, 1e-14);
        // 125 terms below 1 in any order: 125 u sum|w c| / total, with lobes of a few per cent.
        EXPECT_NEAR(single.value(0, 0, x, y), sum / total, 125 * 0x1p-24 * 2);
      }
  }
}

TEST(SupersampleResolve, KeepsTheLawOfTiles) {
  for (const int period : {1, 2, 16})
    for (const char* params : {R"({"filter": "box"})", R"({"filter": "bartlett"})",
                               R"({"filter": "gaussian", "radius": 2.6})", "{}"}) {
      const auto in = image({-7, 2, 50, 31}, random_pattern(4, period), 5, patchy(2));
      EXPECT_EQ(test::break_of_tile_law({nodes::supersample_resolve(), params, {{"image", {in}}}}), "")
          << period << params;
    }
  const auto wide = image({0, 0, 40, 30}, random_pattern(3, 2), 1, patchy(2), PlaneKind::f64);
  EXPECT_EQ(test::break_of_tile_law(
                {nodes::supersample_resolve(), "{}", {{"image", {wide}}}, Precision::real_double}),
            "");
}

TEST(SupersampleResolve, EveryTargetHasTheBytesOfTheScalarTwin) {
  for (const int period : {1, 8}) {
    const auto in = image({0, 0, 83, 20}, random_pattern(6, period), 5, patchy(5));
    const test::PixelRun run(nodes::supersample_resolve(), "{}", {{"image", {in}}});
    // 1 px wide tiles go through the scalar twin throughout.
    std::vector<Rect> columns;
    for (int x = 0; x < 83; ++x) columns.push_back({x, 0, x + 1, 20});
    const Raster truth = run.pieced(columns);
    test::for_each_simd_target(
        [&](const char* target) { EXPECT_EQ(test::first_difference(run.whole(), truth), "") << target; });
  }
}

TEST(SupersampleResolve, AConstantKeepsItsBitsUpToTheBorder) {
  for (const char* filter : {"box", "bartlett", "gaussian", "mitchell"})
    for (const double c : {0.1, 1.0 / 3, 7e-41, -0.0, 1e30}) {
      const auto in = image({0, 0, 21, 9}, random_pattern(16, 2), 2, [&](int, int, int, int) { return c; });
      const Raster out = resolved(in, std::string(R"({"filter": ")") + filter + "\"}");
      for (int y = 0; y < 9; ++y)
        for (int x = 0; x < 21; ++x)
          ASSERT_EQ(std::bit_cast<std::uint32_t>(out.at<float>(1, 0, x, y)),
                    std::bit_cast<std::uint32_t>(static_cast<float>(c)));
    }
}

TEST(SupersampleResolve, ARampStaysARampInside) {
  const auto pattern = grid_pattern(4);
  const auto in = image({0, 0, 16, 8}, pattern, 1, [&](int, int s, int x, int) {
    return x + pattern->x[static_cast<std::size_t>(s)] / 4096.0;
  });
  for (const char* filter : {"box", "bartlett", "gaussian", "mitchell"}) {
    const Raster out = resolved(in, std::string(R"({"filter": ")") + filter + "\"}", Precision::real_double);
    for (int x = 2; x < 14; ++x) EXPECT_NEAR(out.value(0, 0, x, 4), x + 0.5, 1e-13) << filter;
  }
}

TEST(SupersampleResolve, AnEdgeHasItsClosedForm) {
  // 1 to the left of 5.75: a quarter of a pixel right of the centre of pixel 5.
  const auto pattern = grid_pattern(64);
  const auto in = image({0, 0, 10, 3}, pattern, 1, [&](int, int s, int x, int) {
    return x + pattern->x[static_cast<std::size_t>(s)] / 4096.0 < 5.75 ? 1 : 0;
  });
  EXPECT_EQ(resolved(in, R"({"filter": "box"})").value(0, 0, 5, 1), 0.75);
  EXPECT_NEAR(resolved(in, R"({"filter": "bartlett"})", Precision::real_double).value(0, 0, 5, 1), 0.71875,
              1e-4);  // midpoint rule, h = 1/64
}

TEST(SupersampleResolve, ABoxIsTheMeanOfThePixelsOwnSamples) {
  const auto in = image({0, 0, 30, 4}, random_pattern(8, 1), 1, patchy(8));
  const Raster out = resolved(in, R"({"filter": "box"})", Precision::real_double);
  for (int x = 0; x < 30; ++x) {
    double sum = 0;
    for (int s = 0; s < 8; ++s) sum += in->raster.value(0, s, x, 2);
    EXPECT_NEAR(out.value(0, 0, x, 2), sum / 8, 1e-15);
  }
}

TEST(SupersampleResolve, APixelAloneSeesOnlyItself) {
  const auto in = image({3, 4, 4, 5}, random_pattern(4, 1), 1, [](int, int s, int, int) { return s; });
  const double v = resolved(in, "{}").value(0, 0, 3, 4);
  EXPECT_GE(v, 0);
  EXPECT_LE(v, 3);
}

TEST(SupersampleResolve, WithoutAWeightTheFirstSampleStands) {
  auto corner = std::make_shared<SamplePattern>();
  corner->samples = 2, corner->x = {0, 0}, corner->y = {0, 0};  // where Bartlett of radius 1/2 has run out
  const auto in = image({0, 0, 20, 2}, corner, 1, [](int, int s, int x, int) { return 10 * s + x; });
  const Raster out = resolved(in, R"({"filter": "bartlett", "radius": 0.5})");
  for (int x = 0; x < 20; ++x) EXPECT_EQ(out.value(0, 0, x, 1), x);
}

TEST(SupersampleResolve, KeepsTheWindowAndLeavesIntegersOut) {
  Frame f{.window = {2, 3, 12, 9},
          .pattern = random_pattern(2, 1),
          .planes = {{"id", PlaneKind::u32}, {"R"}},
          .color_space = "c"};
  const test::PixelRun run(nodes::supersample_resolve(), "{}",
                           {{"image", {std::make_shared<const Image>(Image{Raster(f)})}}});
  EXPECT_EQ(run.frame().window, f.window);
  EXPECT_EQ(run.frame().pattern, nullptr);
  EXPECT_EQ(run.frame().planes, PlaneList{{"R"}});
  EXPECT_EQ(run.frame().color_space, "c");
}

}  // namespace
}  // namespace frustum
