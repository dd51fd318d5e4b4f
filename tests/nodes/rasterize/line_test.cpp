#include "nodes/rasterize/line.h"

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <map>
#include <numbers>
#include <random>
#include <set>

namespace frustum {
namespace {

using line::Ends;
using line::GridPoint;
using line::Step;
using line::Ties;
using line::Wide;
using Pixel = std::pair<int, int>;

const kernels::PixelRect everywhere{-60000, -60000, 60000, 60000};

GridPoint middle_of(int x, int y) { return {x * line::grid + line::half, y * line::grid + line::half}; }

template <class Draw>
std::vector<Step> steps_of(const Draw& draw) {
  std::vector<Step> out;
  draw([&](const Step& s) { out.push_back(s); });
  return out;
}
std::vector<Step> bresenham(GridPoint from, GridPoint to, Ends ends = Ends::closed, Ties ties = Ties::fixed,
                            const kernels::PixelRect& window = everywhere) {
  return steps_of([&](const auto& visit) { line::bresenham(from, to, ends, ties, window, visit); });
}
std::vector<Pixel> pixels_of(const std::vector<Step>& steps) {
  std::vector<Pixel> out;
  for (const Step& s : steps) out.emplace_back(s.x, s.y);
  return out;
}
std::vector<Pixel> sorted(std::vector<Pixel> p) {
  std::sort(p.begin(), p.end());
  return p;
}

// ----- one pixel a column

// The course's loop with its braces and semicolon put in (errata E16), for 0 <= dy <= dx.
std::vector<Step> by_the_course(int dx, int dy) {
  std::vector<Step> out;
  int d = 2 * dy - dx, y = 0;
  for (int x = 0; x <= dx; ++x) {
    out.push_back({x, y, double(d), 1});
    if (d > 0)
      d += 2 * (dy - dx), ++y;
    else
      d += 2 * dy;
  }
  return out;
}

TEST(RasterizeLine, TakesTheStepsAndDecisionsOfTheCourseInItsOctant) {
  int lines = 0, differ_reversed = 0;
  for (int dx = 0; dx <= 40; ++dx)
    for (int dy = 0; dy <= dx; ++dy, ++lines) {
      const auto steps = bresenham(middle_of(0, 0), middle_of(dx, dy), Ends::closed, Ties::stay);
      const auto expected = by_the_course(dx, dy);
      ASSERT_EQ(pixels_of(steps), pixels_of(expected)) << dx << " " << dy;
      for (std::size_t i = 0; i < steps.size(); ++i) {
        EXPECT_EQ(steps[i].decision, dx == 0 ? 0 : expected[i].decision) << dx << " " << dy << " step " << i;
        // The oracle: no pixel middle is nearer to the line.
        EXPECT_LE(std::abs(2 * steps[i].y * dx - 2 * steps[i].x * dy), std::max(dx, 1));
      }
      const auto back = bresenham(middle_of(dx, dy), middle_of(0, 0), Ends::closed, Ties::stay);
      differ_reversed += sorted(pixels_of(back)) != sorted(pixels_of(steps)) ? 1 : 0;
    }
  EXPECT_EQ(lines, 861);
  EXPECT_EQ(differ_reversed, 284);
}

TEST(RasterizeLine, TakesTheNearestPixelOfEveryColumnInAllOctantsAndBothWays) {
  std::mt19937 random(11);
  std::uniform_int_distribution<std::int64_t> coordinate(-3000, 3000);
  for (int i = 0; i < 4000; ++i) {
    const GridPoint p{coordinate(random), coordinate(random)}, q{coordinate(random), coordinate(random)};
    const auto steps = bresenham(p, q);
    const bool steep = std::llabs(q.y - p.y) > std::llabs(q.x - p.x);
    const std::int64_t a0 = steep ? p.y : p.x, b0 = steep ? p.x : p.y, a1 = steep ? q.y : q.x,
                       b1 = steep ? q.x : q.y;
    ASSERT_EQ(static_cast<std::int64_t>(steps.size()),
              std::llabs(line::floor_div(a1, line::grid) - line::floor_div(a0, line::grid)) + 1);
    for (const Step& s : steps) {
      const std::int64_t column = steep ? s.y : s.x, row = steep ? s.x : s.y;
      // row <= b(column) / grid < row + 1, with both sides multiplied by |a1 - a0|.
      const std::int64_t length = std::llabs(a1 - a0), sign = a1 > a0 ? 1 : -1;
      if (length == 0) continue;
      const std::int64_t b = b0 * length + sign * (b1 - b0) * (column * line::grid + line::half - a0);
      EXPECT_GE(b, row * line::grid * length);
      EXPECT_LT(b, (row + 1) * line::grid * length);
    }
    EXPECT_EQ(sorted(pixels_of(bresenham(q, p))), sorted(pixels_of(steps))) << "reversed";
  }
}

// What the whole line draws inside the window, by exact division column by column.
std::vector<Pixel> walked(GridPoint p, GridPoint q, const kernels::PixelRect& w) {
  const line::Walk walk(p, q);
  std::vector<Pixel> out;
  const auto [first, last] = *walk.columns(Ends::closed);
  for (std::int64_t k = std::max<std::int64_t>(std::min(first, last), walk.steep() ? w.y0 : w.x0);
       k <= std::min<std::int64_t>(std::max(first, last), (walk.steep() ? w.y1 : w.x1) - 1); ++k) {
    const std::int64_t r = walk.row(k, Ties::fixed), x = walk.steep() ? r : k, y = walk.steep() ? k : r;
    if (x >= w.x0 && x < w.x1 && y >= w.y0 && y < w.y1)
      out.emplace_back(static_cast<int>(x), static_cast<int>(y));
  }
  return out;
}

TEST(RasterizeLine, DrawsWhatIsSeenOfAnyLineWithoutMovingIt) {
  const kernels::PixelRect screen{0, 0, 640, 480};
  const std::pair<GridPoint, GridPoint> lines[] = {
      {middle_of(-1000000, 3), middle_of(1000000, 517)},
      {middle_of(1000000, 517), middle_of(-1000000, 3)},
      {middle_of(-(1 << 29), -(1 << 29) - 7), middle_of(1 << 29, (1 << 29) + 11)},
      {{-(std::int64_t{1} << 38), 12345}, {std::int64_t{1} << 38, 54321}},
      {{777, -(std::int64_t{1} << 38)}, {99999, std::int64_t{1} << 38}},
      {{5, -(std::int64_t{1} << 38)}, {5, -(std::int64_t{1} << 37)}}};
  for (const auto& [p, q] : lines) {
    const auto steps = bresenham(p, q, Ends::closed, Ties::fixed, screen);
    EXPECT_EQ(sorted(pixels_of(steps)), sorted(walked(p, q, screen)));
    EXPECT_LE(steps.size(), 640u);
  }
  // The naive clip: from the pixel where the line comes into sight to the one where it leaves.
  int moved = 0;
  for (int i = 0; i < 40; ++i) {
    const GridPoint p = middle_of(-1000 - 31 * i, -40 + i), q = middle_of(1500, 451 - 3 * i);
    const auto whole = sorted(walked(p, q, screen));
    const auto naive = bresenham(middle_of(whole.front().first, whole.front().second),
                                 middle_of(whole.back().first, whole.back().second));
    moved += sorted(pixels_of(naive)) != whole ? 1 : 0;
    EXPECT_EQ(sorted(pixels_of(bresenham(p, q, Ends::closed, Ties::fixed, screen))), whole);
  }
  EXPECT_GT(moved, 20);
}

TEST(RasterizeLine, StepsWithoutAccumulatingErrors) {
  const GridPoint p = middle_of(0, 0), q = middle_of(16384, 5461);
  const auto exact = bresenham(p, q);
  const auto dda = steps_of([&](const auto& visit) { line::dda(p, q, Ends::closed, everywhere, visit); });
  EXPECT_EQ(pixels_of(dda), pixels_of(exact));
  float y = 0.5F;
  int wrong = 0;
  for (const Step& s : exact) {
    wrong += static_cast<int>(std::floor(y)) != s.y ? 1 : 0;
    y += 5461.0F / 16384.0F;
  }
  EXPECT_GT(wrong, 100) << "adding the slope again and again in single precision";
}

// ----- the diamond rule, from its definition

// Whether the segment meets the open diamond about the middle of a pixel, by exact fractions.
bool meets_diamond(GridPoint p, GridPoint q, int x, int y) {
  const auto f = [&](GridPoint g, int k) -> std::int64_t {
    const std::int64_t u = g.x - (x * line::grid + line::half), v = g.y - (y * line::grid + line::half);
    return line::half - ((k & 1) != 0 ? u : -u) - ((k & 2) != 0 ? v : -v);
  };
  Wide low = 0, low_of = 1, high = 1, high_of = 1;  // low / low_of < t < high / high_of
  for (int k = 0; k < 4; ++k) {
    const std::int64_t at = f(p, k), change = f(q, k) - at;
    if (change == 0 && at <= 0) return false;
    if (change > 0 && Wide{-at} * low_of > low * change) low = -at, low_of = change;
    if (change < 0 && Wide{at} * high_of < high * -change) high = at, high_of = -change;
  }
  return low * high_of < high * low_of;
}
bool inside_diamond(GridPoint p, int x, int y) {
  return std::llabs(p.x - (x * line::grid + line::half)) + std::llabs(p.y - (y * line::grid + line::half)) <
         line::half;
}
bool touches_a_corner(GridPoint p, GridPoint q) {
  const line::Walk w(p, q);
  for (int k = -30; k <= 30; ++k)
    if (w.length() == 0 || w.numerator(k) % (Wide{w.length()} * line::grid) == 0) return true;
  return false;
}

TEST(RasterizeLine, DrawsThePixelsWhoseDiamondsItLeaves) {
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int64_t> coordinate(-9 * line::grid, 9 * line::grid);
  int compared = 0;
  for (int i = 0; i < 3000; ++i) {
    const GridPoint p{coordinate(random), coordinate(random)}, q{coordinate(random), coordinate(random)};
    if (touches_a_corner(p, q)) continue;
    ++compared;
    std::vector<Pixel> expected;
    for (int x = -11; x <= 11; ++x)
      for (int y = -11; y <= 11; ++y)
        if (meets_diamond(p, q, x, y) && !inside_diamond(q, x, y)) expected.emplace_back(x, y);
    ASSERT_EQ(sorted(pixels_of(bresenham(p, q, Ends::diamond))), expected)
        << p.x << " " << p.y << " to " << q.x << " " << q.y;
  }
  EXPECT_GT(compared, 2000);
}

TEST(RasterizeLine, DrawsNoPixelOfAPathTwiceAndLeavesNoGap) {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int64_t> along(0, 3 * line::grid), aside(-100, 100);
  std::size_t twice_when_closed = 0;
  for (int trial = 0; trial < 300; ++trial) {
    GridPoint at{line::half, line::half};
    std::map<int, int> columns, closed;
    int last = 0;
    for (int i = 0; i < 20; ++i) {
      const std::int64_t dx = along(random);
      const GridPoint next{at.x + dx, at.y + aside(random) * dx / 101};
      for (const Step& s : bresenham(at, next, Ends::diamond)) ++columns[s.x], last = std::max(last, s.x);
      for (const Step& s : bresenham(at, next, Ends::closed)) ++closed[s.x];
      at = next;
    }
    for (int x = 0; x <= last; ++x) EXPECT_EQ(columns[x], 1) << "trial " << trial << " column " << x;
    for (const auto& [x, n] : closed) twice_when_closed += n > 1 ? 1 : 0;
  }
  EXPECT_GT(twice_when_closed, 1000u) << "closed ends draw joints twice";
}

// ----- smooth lines

double ink(const std::vector<Step>& steps) {
  double sum = 0;
  for (const Step& s : steps) sum += s.coverage;
  return sum;
}

TEST(RasterizeLine, SharesOneUnitOfInkAColumn) {
  std::mt19937 random(8);
  std::uniform_int_distribution<std::int64_t> coordinate(-4000, 4000);
  for (int i = 0; i < 500; ++i) {
    const GridPoint p{coordinate(random), coordinate(random)}, q{coordinate(random), coordinate(random)};
    const auto steps = steps_of([&](const auto& visit) { line::wu(p, q, everywhere, visit); });
    const auto longest = static_cast<double>(std::max(std::llabs(q.x - p.x), std::llabs(q.y - p.y)));
    EXPECT_NEAR(ink(steps), longest / line::grid, 1e-12 * longest);
    const line::Walk w(p, q);
    for (const Step& s : steps) {
      // The share falls off linearly with the distance across.
      const std::int64_t column = w.steep() ? s.y : s.x, row = w.steep() ? s.x : s.y;
      const double b =
          static_cast<double>(w.numerator(column)) / static_cast<double>(w.length()) / line::grid;
      EXPECT_LE(s.coverage, 1 - std::fabs(b - (static_cast<double>(row) + 0.5)) + 1e-12);
    }
  }
}

TEST(RasterizeLine, WeighsDistancesByAConeOfVolumeOne) {
  for (const double h : {-1.2, -0.7, 0.0, 0.001, 0.3, 0.9, 0.9999, 1.5}) {
    double sum = 0;  // of sections, by the midpoint rule on both axes
    constexpr int n = 600;
    for (int i = 0; i < n; ++i) {
      const double x = -1 + (i + 0.5) * 2 / n;
      if (x < h) continue;
      for (int k = 0; k < n; ++k) {
        const double y = -1 + (k + 0.5) * 2 / n;
        sum += std::max(0.0, 1 - std::sqrt(x * x + y * y));
      }
    }
    EXPECT_NEAR(line::cone_beyond(h), sum * 4 / (n * n) * 3 / std::numbers::pi, 2e-3) << h;
  }
  EXPECT_EQ(line::cone_beyond(0), 0.5);
  double ink_across = 0;  // of a stripe of width 1, over all distances: its width
  for (int i = -2000; i < 2000; ++i) ink_across += line::cone_coverage((i + 0.5) / 1000, 1) / 1000;
  EXPECT_NEAR(ink_across, 1, 1e-6);
}

TEST(RasterizeLine, HasTheSameInkAtEverySlopeByDistanceAndNotByColumns) {
  const auto turned = [](double degrees) {
    const double t = degrees * std::numbers::pi / 180;
    return std::pair{*line::snapped({300.5, 300.5}),
                     *line::snapped({300.5 + 200 * std::cos(t), 300.5 + 200 * std::sin(t)})};
  };
  const kernels::PixelRect window{0, 0, 600, 600};
  for (const double degrees : {0.0, 17.0, 45.0, 80.0, 135.0, 251.0}) {
    const auto [p, q] = turned(degrees);
    const auto cone =
        steps_of([&, p = p, q = q](const auto& visit) { line::gupta_sproull(p, q, 1, window, visit); });
    const auto area =
        steps_of([&, p = p, q = q](const auto& visit) { line::exact_area(p, q, 1, window, visit); });
    EXPECT_NEAR(ink(cone) / ink(area), 1, 0.02) << degrees;  // the round ends add some half a pixel each
    const double length =
        std::hypot(static_cast<double>(q.x - p.x), static_cast<double>(q.y - p.y)) / line::grid;
    EXPECT_NEAR(ink(area), length, 1e-10) << degrees;
  }
  const auto [p, q] = turned(45);
  const auto wu = steps_of([&, p = p, q = q](const auto& visit) { line::wu(p, q, window, visit); });
  EXPECT_NEAR(ink(wu) / 200, std::numbers::sqrt2 / 2, 0.01) << "a diagonal by columns is too faint";
}

TEST(RasterizeLine, MirrorsWithItsEnds) {
  const auto key = [](int x, int y) { return std::pair{x, y}; };
  const GridPoint p{1000, 2000}, q{5077, 3311};
  std::map<Pixel, double> upright, mirrored;
  line::gupta_sproull(p, q, 1.5, everywhere, [&](const Step& s) { upright[key(s.x, s.y)] = s.coverage; });
  line::gupta_sproull({-p.x, p.y}, {-q.x, q.y}, 1.5, everywhere,
                      [&](const Step& s) { mirrored[key(-1 - s.x, s.y)] = s.coverage; });
  EXPECT_EQ(upright, mirrored);
}

// ----- the node

Json seen(const Json& changes) {
  Json params = {{"segments", Json::array({{{"from", {0.5, 0.5}}, {"to", {7.5, 3.5}}}})},
                 {"resolution", {10, 6}}};
  params.update(changes);
  return params;
}

TEST(RasterizeLine, ListsItsSteps) {
  const auto out = test::run_node(nodes::rasterize_line(), seen(Json::object()));
  const auto steps = out.at(1).as<Table>();
  ASSERT_EQ(steps->columns.at(4).name, "decision");
  EXPECT_THAT(steps->columns[2].numbers, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(steps->columns[3].numbers, testing::ElementsAre(0, 0, 1, 1, 2, 2, 3, 3));
  EXPECT_THAT(steps->columns[4].numbers, testing::ElementsAre(-1, 5, -3, 3, -5, 1, -7, -1));
  const auto image = out.at(0).as<Image>();
  EXPECT_EQ(image->raster.value(3, 0, 2, 1), 1);
  EXPECT_EQ(image->raster.value(3, 0, 2, 0), 0);
}

TEST(RasterizeLine, JoinsPointsAndMeshEdges) {
  const auto points =
      std::make_shared<const Points>(Points{{{1.5, 1.5, 9}, {4.5, 1.5, 0}, {4.5, 4.5, 0}, {1.5, 4.5, 0}}});
  const auto count = [&](const char* connect) {
    const auto out = test::run_node(nodes::rasterize_line(), {{"connect", connect}, {"resolution", {6, 6}}},
                                    {{points}, {}});
    return out.at(1).as<Table>()->rows();
  };
  EXPECT_EQ(count("path"), 12u);
  EXPECT_EQ(count("pairs"), 8u);
  EXPECT_EQ(count("dots"), 4u);
  const auto mesh = test::shared(test::mesh_of(
      std::vector<glm::vec4>{{1, 1, 0, 1}, {5, 1, 0, 1}, {5, 5, 0, 1}, {1, 5, 0, 1}, {NAN, 1, 0, 1}},
      {{0, 1, 2}, {0, 2, 3}, {0, 1, 4}}, Space::screen));
  Context ctx;
  const auto out = test::run_node(nodes::rasterize_line(), {{"resolution", {6, 6}}}, {{}, {mesh}}, &ctx);
  EXPECT_EQ(out.at(1).as<Table>()->columns[0].numbers.back(), 4) << "five edges of two triangles";
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "segments_out_of_range");
}

TEST(RasterizeLine, AddsOrTakesTheStrongestWhereSegmentsMeet) {
  const Json cross =
      Json::array({{{"from", {0.5, 2.5}}, {"to", {4.5, 2.5}}}, {{"from", {2.5, 0.5}}, {"to", {2.5, 4.5}}}});
  const auto red = [&](const char* overlap) {
    const auto out = test::run_node(nodes::rasterize_line(),
                                    seen({{"segments", cross}, {"overlap", overlap}, {"color", 0.25}}));
    return out.at(0).as<Image>()->raster.value(0, 0, 2, 2);
  };
  EXPECT_EQ(red("strongest"), 0.25);
  EXPECT_EQ(red("sum"), 0.5);
}

TEST(RasterizeLine, RefusesAPictureThatIsTooLarge) {
  EXPECT_EQ(test::run_error(nodes::rasterize_line(), {{"resolution", {70000, 2}}}).first, "too_large");
}

}  // namespace
}  // namespace frustum
