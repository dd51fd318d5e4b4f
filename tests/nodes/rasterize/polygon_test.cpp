#include "nodes/rasterize/polygon.h"

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/value.h"
#include "tests/nodes/kernels/screen_scene.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <random>

namespace frustum {
namespace {

using kernels::FillRule;
using polygon::GridPoint;
using polygon::Side;
__extension__ using Wide = __int128;

using Contour = std::vector<GridPoint>;

std::vector<Side> sides_of(const std::vector<Contour>& contours) {
  std::vector<Side> sides;
  for (const Contour& c : contours) polygon::add_sides(sides, c);
  return sides;
}

std::vector<int> windings(const std::vector<Contour>& contours, const test::Pattern& pattern,
                          kernels::PixelRect w) {
  polygon::WindingRows rows(sides_of(contours), pattern.view(), w);
  const auto width = static_cast<std::size_t>(w.x1 - w.x0), height = static_cast<std::size_t>(w.y1 - w.y0);
  const std::size_t row = width * static_cast<std::size_t>(pattern.samples);
  std::vector<int> out(row * height);
  for (std::size_t y = 0; y < height; ++y)
    rows.row(w.y0 + static_cast<int>(y), std::span(out).subspan(y * row, row));
  return out;
}

// The oracle: crossings of the ray to the left, every side and every sample in 128-bit integers of 2^-12 px.
int winding_at(const std::vector<Contour>& contours, std::int64_t x, std::int64_t y) {
  int winding = 0;
  for (const Contour& c : contours)
    for (std::size_t i = 0; i < c.size(); ++i) {
      const GridPoint &p = c[i], &q = c[(i + 1) % c.size()];
      const std::int64_t py = std::int64_t{p.y} * 16, qy = std::int64_t{q.y} * 16,
                         px = std::int64_t{p.x} * 16, qx = std::int64_t{q.x} * 16;
      const bool down = py <= y && y < qy, up = qy <= y && y < py;
      if (!down && !up) continue;
      // x >= px + (qx - px) (y - py) / (qy - py)
      const Wide left = Wide{x - px} * (qy - py), right = Wide{qx - px} * (y - py);
      if (down ? left >= right : left <= right) winding += down ? 1 : -1;
    }
  return winding;
}

Contour random_contour(std::mt19937& random, int corners, int reach_px) {
  std::uniform_int_distribution<std::int32_t> at(-reach_px * 256 / 4, reach_px * 256);
  Contour c;
  for (int i = 0; i < corners; ++i) c.push_back({at(random), at(random)});
  return c;
}

TEST(RasterizePolygon, CountsTheExactWindingNumberOfEverySample) {
  std::mt19937 random(4);
  test::Random pattern_random(9);
  for (int trial = 0; trial < 120; ++trial) {
    const int period = 1 << (trial % 4), samples = 1 + trial % 3;
    const test::Pattern pattern = test::random_pattern(pattern_random, samples, period);
    const kernels::PixelRect window{trial % 5, trial % 7, 24 + trial % 9, 21};
    const std::vector<Contour> contours{random_contour(random, 3 + trial % 9, 30),
                                        random_contour(random, 5, 12)};
    const auto got = windings(contours, pattern, window);
    std::size_t i = 0;
    for (int y = window.y0; y < window.y1; ++y)
      for (int k = 0; k < samples; ++k)
        for (int x = window.x0; x < window.x1; ++x, ++i) {
          const std::size_t at = pattern.view().index(k, x, y);
          ASSERT_EQ(got[i], winding_at(contours, x * std::int64_t{4096} + pattern.x[at],
                                       y * std::int64_t{4096} + pattern.y[at]))
              << "trial " << trial << " pixel " << x << " " << y << " sample " << k;
        }
  }
}

// Corners on pixel middles, so that samples lie on sides all the time.
TEST(RasterizePolygon, CoversWhatTheTrianglesCover) {
  std::mt19937 random(6);
  std::uniform_int_distribution<int> at(0, 24);
  for (int trial = 0; trial < 500; ++trial) {
    test::ScreenScene<double> scene;
    Contour c;
    std::array<std::array<double, 3>, 3> corner;
    for (auto& p : corner) {
      p = {at(random) * 0.5, at(random) * 0.5, 0.5};
      c.push_back(*polygon::snapped({p[0], p[1]}));
    }
    scene.triangle(corner[0], corner[1], corner[2]);
    const kernels::PixelRect window{0, 0, 13, 13};
    const auto seen = test::fill(scene, test::Pattern{}, window, test::Twin::scalar);
    const auto winding = windings({c}, test::Pattern{}, window);
    for (std::size_t i = 0; i < winding.size(); ++i)
      ASSERT_EQ(winding[i] != 0, seen.id[i] == 0) << "trial " << trial << " pixel " << i;
  }
}

// A fan of quads around points on the grid of samples: each sample of the square belongs to one of them.
TEST(RasterizePolygon, NeighboursShareNoSampleAndLeaveNoneOut) {
  std::mt19937 random(12);
  std::uniform_int_distribution<std::int32_t> inner(2, 62);
  const kernels::PixelRect window{0, 0, 16, 16};
  for (int trial = 0; trial < 200; ++trial) {
    const GridPoint c{inner(random) * 64, inner(random) * 64};
    const std::int32_t far = 16 * 256;
    const GridPoint n{inner(random) * 64, 0}, s{inner(random) * 64, far}, w{0, inner(random) * 64},
        e{far, inner(random) * 64};
    const std::vector<Contour> quads{
        {{0, 0}, n, c, w}, {n, {far, 0}, e, c}, {c, e, {far, far}, s}, {w, c, s, {0, far}}};
    std::vector<int> times(256, 0);
    std::vector<double> area(256, 0);
    for (const Contour& quad : quads) {
      const auto winding = windings({quad}, test::Pattern{}, window);
      for (std::size_t i = 0; i < 256; ++i) times[i] += winding[i] != 0 ? 1 : 0;
      kernels::AreaSweep sweep(polygon::area_edges(sides_of({quad})), FillRule::nonzero, window);
      sweep.rows([&](int y, std::span<const double> shares) {
        for (std::size_t x = 0; x < 16; ++x) area[static_cast<std::size_t>(y) * 16 + x] += shares[x];
      });
    }
    for (std::size_t i = 0; i < 256; ++i) {
      ASSERT_EQ(times[i], 1) << "trial " << trial << " pixel " << i;
      ASSERT_NEAR(area[i], 1, 4 * 0x1p-52) << "trial " << trial << " pixel " << i;
    }
  }
}

// ----- area

std::vector<double> area_of(const std::vector<Contour>& contours, FillRule rule, kernels::PixelRect w) {
  const auto width = static_cast<std::size_t>(w.x1 - w.x0);
  std::vector<double> out(width * static_cast<std::size_t>(w.y1 - w.y0), 0.0);
  kernels::AreaSweep sweep(polygon::area_edges(sides_of(contours)), rule, w);
  int last = w.y0 - 1;
  sweep.rows([&](int y, std::span<const double> shares) {
    EXPECT_GT(y, last) << "a row is given once";
    last = y;
    std::copy(shares.begin(), shares.end(),
              out.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y - w.y0) * width));
  });
  return out;
}

// The oracle for one triangle: the pixel's square clipped by its three half-planes, in long double.
double clipped_area(const Contour& t, int x, int y) {
  using Point = std::pair<long double, long double>;
  std::vector<Point> ring{{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}};
  const auto at = [&](std::size_t i) { return Point{t[i % 3].x / 256.0L, t[i % 3].y / 256.0L}; };
  const auto cross = [](Point a, Point b, Point p) {
    return (b.first - a.first) * (p.second - a.second) - (b.second - a.second) * (p.first - a.first);
  };
  const long double turn = cross(at(0), at(1), at(2)) > 0 ? 1 : -1;
  for (std::size_t side = 0; side < 3; ++side) {
    std::vector<Point> cut;
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Point p = ring[i], q = ring[(i + 1) % ring.size()];
      const long double dp = turn * cross(at(side), at(side + 1), p),
                        dq = turn * cross(at(side), at(side + 1), q);
      if (dp >= 0) cut.push_back(p);
      if ((dp < 0) != (dq < 0)) {
        const long double u = dp / (dp - dq);
        cut.emplace_back(p.first + (q.first - p.first) * u, p.second + (q.second - p.second) * u);
      }
    }
    ring = cut;
  }
  long double area = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point p = ring[i], q = ring[(i + 1) % ring.size()];
    area += (p.first - x) * (q.second - y) - (q.first - x) * (p.second - y);
  }
  return static_cast<double>(std::abs(area) / 2);
}

TEST(RasterizePolygon, CoversTheExactAreaOfATriangleInEveryPixel) {
  std::mt19937 random(21);
  const kernels::PixelRect window{0, 0, 20, 18};
  for (int trial = 0; trial < 200; ++trial) {
    const Contour t = random_contour(random, 3, 25);
    const auto got = area_of({t}, FillRule::nonzero, window);
    for (int y = 0; y < 18; ++y)
      for (int x = 0; x < 20; ++x)
        ASSERT_NEAR(got[static_cast<std::size_t>(y * 20 + x)], clipped_area(t, x, y), 1e-13)
            << "trial " << trial << " pixel " << x << " " << y;
  }
}

TEST(RasterizePolygon, CoversTheAreaByItsRuleWhereItCrossesItself) {
  std::mt19937 random(33);
  const kernels::PixelRect window{0, 0, 12, 12};
  test::Pattern fine{1024, 1, {}, {}};  // a grid of 32 x 32 samples
  fine.x.clear(), fine.y.clear();
  for (int i = 0; i < 1024; ++i) {
    fine.x.push_back(static_cast<std::uint16_t>(i % 32 * 128 + 64));
    fine.y.push_back(static_cast<std::uint16_t>(i / 32 * 128 + 64));
  }
  for (int trial = 0; trial < 30; ++trial) {
    const std::vector<Contour> contours{random_contour(random, 7, 14), random_contour(random, 4, 10)};
    const auto winding = windings(contours, fine, window);
    for (const FillRule rule : {FillRule::even_odd, FillRule::nonzero}) {
      const auto got = area_of(contours, rule, window);
      for (std::size_t y = 0; y < 12; ++y)
        for (std::size_t x = 0; x < 12; ++x) {
          int inside = 0;
          for (std::size_t k = 0; k < 1024; ++k)
            inside += kernels::is_inside(winding[(y * 1024 + k) * 12 + x], rule) ? 1 : 0;
          // Up to eleven sides cross the pixel, each some 32 of its cells, half of one off at most.
          ASSERT_NEAR(got[y * 12 + x], inside / 1024.0, 0.1) << "trial " << trial;
          if (inside == 0 || inside == 1024) {
            ASSERT_NEAR(got[y * 12 + x], inside / 1024.0, 0.05) << "trial " << trial;
          }
        }
    }
  }
}

TEST(RasterizePolygon, AddsUpToTheAreaOfTheShoelace) {
  const Contour star{{1000, 100}, {1200, 900}, {2100, 1000}, {1300, 1400}, {1500, 2300},
                     {900, 1600}, {200, 2000}, {600, 1200},  {100, 600},   {800, 800}};
  double twice = 0;
  for (std::size_t i = 0; i < star.size(); ++i) {
    const GridPoint &p = star[i], &q = star[(i + 1) % star.size()];
    twice += double(p.x) * q.y - double(q.x) * p.y;
  }
  const auto shares = area_of({star}, FillRule::nonzero, {0, 0, 10, 10});
  double sum = 0;
  for (const double s : shares) sum += s;
  EXPECT_NEAR(sum, std::abs(twice) / 2 / 65536, 1e-12);
}

// ----- the node

Json pentagram(const Json& changes) {
  Json params = {{"contours", {{{16, 1}, {25, 29}, {1, 12}, {31, 12}, {7, 29}}}}, {"resolution", {32, 32}}};
  params.update(changes);
  return params;
}
double alpha(const std::vector<Buffer>& out, int x, int y, int sample = 0) {
  return out.at(0).as<Image>()->raster.value(3, sample, x, y);
}

TEST(RasterizePolygon, FillsOrLeavesTheMiddleOfAPentagram) {
  for (const char* coverage : {"samples", "area"}) {
    const auto filled = test::run_node(nodes::rasterize_polygon(), pentagram({{"coverage", coverage}}));
    const auto open =
        test::run_node(nodes::rasterize_polygon(), pentagram({{"coverage", coverage}, {"rule", "even_odd"}}));
    EXPECT_EQ(alpha(filled, 16, 16), 1);
    EXPECT_EQ(alpha(open, 16, 16), 0);
    EXPECT_EQ(alpha(filled, 16, 6), 1);
    EXPECT_EQ(alpha(open, 16, 6), 1);
    EXPECT_EQ(alpha(filled, 2, 2), 0);
  }
}

TEST(RasterizePolygon, ListsItsEdgesAndSpans) {
  const auto out = test::run_node(nodes::rasterize_polygon(),
                                  {{"contours", {{{1, 1}, {5, 1}, {5, 4}, {1, 4}}}}, {"resolution", {8, 8}}});
  const auto edges = out.at(1).as<Table>(), spans = out.at(2).as<Table>();
  EXPECT_EQ(edges->rows(), 2u) << "horizontal sides are none";
  EXPECT_THAT(edges->columns[4].numbers, testing::ElementsAre(-1, 1));
  EXPECT_THAT(spans->columns[0].numbers, testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(spans->columns[1].numbers, testing::ElementsAre(1, 1, 1));
  EXPECT_THAT(spans->columns[2].numbers, testing::ElementsAre(5, 5, 5));
}

TEST(RasterizePolygon, TakesThePatternsSamplesAndPaper) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 2, pattern->x = {1024, 3072}, pattern->y = {2048, 2048};
  const auto out = test::run_node(
      nodes::rasterize_polygon(),
      {{"contours", {{{0, 0}, {1.5, 0}, {1.5, 4}, {0, 4}}}}, {"resolution", {3, 3}}, {"paper", 0.5}},
      {{}, {Ref<SamplePattern>(pattern)}});
  EXPECT_EQ(out.at(0).as<Image>()->raster.value(0, 0, 1, 1), 1);
  EXPECT_EQ(out.at(0).as<Image>()->raster.value(0, 1, 1, 1), 0.5);
  EXPECT_EQ(
      test::run_error(nodes::rasterize_polygon(), {{"coverage", "area"}}, {{}, {Ref<SamplePattern>(pattern)}})
          .first,
      "sampled_image");
}

TEST(RasterizePolygon, LeavesOutCornersThatAreOutOfRange) {
  Context ctx;
  const auto out =
      test::run_node(nodes::rasterize_polygon(),
                     {{"contours", {{{1, 1}, {4, 1}, {1e9, 3}, {1, 4}}}}, {"resolution", {8, 8}}}, {}, &ctx);
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "corners_out_of_range");
  EXPECT_EQ(alpha(out, 1, 1), 1);
}

}  // namespace
}  // namespace frustum
