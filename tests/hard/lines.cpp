// Line rasterization and fill.
#include "nodes/rasterize/fill.h"
#include "nodes/rasterize/line.h"
#include "tests/hard/exact.h"
#include "tests/hard/stages.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <vector>

namespace frustum::hard {
namespace {

using line::Ends;
using line::GridPoint;
using line::Step;
using line::Ties;
using Pixel = std::pair<int, int>;
using glm::dvec2;

GridPoint middle_of(std::int64_t x, std::int64_t y) {
  return {x * line::grid + line::half, y * line::grid + line::half};
}

std::vector<Pixel> drawn(GridPoint p, GridPoint q, const kernels::PixelRect& window,
                         Ends ends = Ends::closed) {
  std::vector<Pixel> out;
  line::bresenham(p, q, ends, Ties::fixed, window, [&](const Step& s) { out.emplace_back(s.x, s.y); });
  return out;
}

// floor(a / b), b > 0.
mpz_class floor_of(const Rational& x) {
  mpz_class out;
  mpz_fdiv_q(out.get_mpz_t(), x.get_num_mpz_t(), x.get_den_mpz_t());
  return out;
}

// The pixel whose middle is nearest to the line between pixel middles, in a column along its longer axis.
Pixel nearest(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, int column, bool steep) {
  const auto of = [](std::int64_t v) { return Rational(mpz_class(static_cast<long>(v))); };
  if (steep) std::swap(x0, y0), std::swap(x1, y1);
  const Rational row =
      of(y0) + (of(column) - of(x0)) * (of(y1) - of(y0)) / (of(x1) - of(x0)) + Rational(1, 2);
  const int r = static_cast<int>(floor_of(row).get_si());
  return steep ? Pixel(r, column) : Pixel(column, r);
}

// The course's loop: one octant, and a decision variable of 32 bits that wraps.
std::vector<Pixel> one_octant(std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1,
                              int columns) {
  const auto wrap = [](std::int64_t v) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(v)); };
  const std::int32_t dx = wrap(x1 - x0), dy = wrap(y1 - y0);
  std::int32_t d = wrap(2 * std::int64_t{dy} - dx);
  std::vector<Pixel> out;
  std::int64_t y = y0;
  for (std::int64_t x = x0; x <= x1 && x - x0 < columns; ++x) {
    out.emplace_back(static_cast<int>(x), static_cast<int>(y));
    if (d > 0)
      d = wrap(std::int64_t{d} + 2 * (std::int64_t{dy} - dx)), ++y;
    else
      d = wrap(std::int64_t{d} + 2 * std::int64_t{dy});
  }
  return out;
}

void judge_line(Trial& t, std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1, int columns) {
  const bool steep = std::llabs(y1 - y0) > std::llabs(x1 - x0);
  const auto from = static_cast<int>(steep ? std::min(y0, y1) : std::min(x0, x1));
  const auto end = static_cast<int>(std::min<std::int64_t>(
      from + std::int64_t{columns}, 1 + (steep ? std::max(y0, y1) : std::max(x0, x1))));
  constexpr int far = std::numeric_limits<int>::max();
  const kernels::PixelRect window =
      steep ? kernels::PixelRect{-far, from, far, end} : kernels::PixelRect{from, -far, end, far};
  std::vector<Pixel> want;
  for (int column = from; column < end; ++column)
    want.push_back(x0 == x1 && y0 == y1 ? Pixel(static_cast<int>(x0), static_cast<int>(y0))
                                        : nearest(x0, y0, x1, y1, column, steep));
  std::sort(want.begin(), want.end());
  auto got = drawn(middle_of(x0, y0), middle_of(x1, y1), window), naive = one_octant(x0, y0, x1, y1, columns);
  std::sort(got.begin(), got.end());
  std::sort(naive.begin(), naive.end());
  t.tally(naive != want, got != want, {double(x0), double(y0), double(x1), double(y1)});
}

void every_octant(Trial& t) {
  for (const int a : {0, 1, 3, 7, 10})
    for (const int b : {0, 1, 3, 7, 10})
      for (const int sign : {1, -1, 2, -2})
        judge_line(t, 0, 0, sign > 0 ? a : -a, sign % 2 == 0 ? b : -b, 100);
  constexpr std::int64_t far = std::int64_t{1} << 29;
  for (std::size_t n = t.samples(100, 10000); n-- > 0;) {
    const auto end = [&] { return static_cast<std::int64_t>(t.random.uniform(-1, 1) * far); };
    judge_line(t, end(), end(), end(), end(), 50);
  }
  judge_line(t, -far, -far, far, far - 1, 50);
  t.price([] { keep(one_octant(0, 0, 1000, 333, 2000)); },
          [] {
            keep(drawn(middle_of(0, 0), middle_of(1000, 333), {0, 0, 2000, 2000}));
          });
}

void accumulated_slope(Trial& t) {
  for (const int dy : {5461, 1, 4097, 16383, 12345}) {
    const GridPoint p = middle_of(0, 0), q = middle_of(16384, dy);
    float y = 0.5F;
    const float slope = static_cast<float>(dy) / 16384;
    line::dda(p, q, Ends::closed, {0, 0, 20000, 20000}, [&](const Step& s) {
      const Pixel want = nearest(0, 0, 16384, dy, s.x, false);
      t.tally(static_cast<int>(std::floor(y)) != want.second, s.y != want.second, {double(s.x), double(dy)});
      y += slope;
    });
  }
  const auto naive = [] {
    float y = 0.5F;
    int sum = 0;
    for (int x = 0; x <= 16384; ++x) sum += static_cast<int>(y), y += 1.0F / 3;
    keep(sum);
  };
  t.price(naive, [] {
    int sum = 0;
    line::dda(middle_of(0, 0), middle_of(16384, 5461), Ends::closed, {0, 0, 20000, 20000},
              [&](const Step& s) { sum += s.y; });
    keep(sum);
  });
}

// A path that never goes back along x: the pixels of its segments, and how often each was drawn.
std::map<Pixel, int> times_drawn(const std::vector<GridPoint>& path, Ends ends) {
  std::map<Pixel, int> out;
  for (std::size_t i = 1; i < path.size(); ++i)
    for (const Pixel& p : drawn(path[i - 1], path[i], {-9999, -9999, 9999, 9999}, ends)) ++out[p];
  return out;
}

void joints_of_a_path(Trial& t) {
  for (std::size_t n = t.samples(200, 20000); n-- > 0;) {
    std::vector<GridPoint> path{middle_of(0, 0)};
    for (int i = 0; i < 20; ++i) {
      // Now and then exactly onto an edge or a corner of a diamond.
      const std::int64_t unit = t.random.below(3) == 0 ? line::half : 1;
      const auto dx = static_cast<std::int64_t>(t.random.below(static_cast<std::size_t>(700 / unit))) * unit;
      const auto dy =
          static_cast<std::int64_t>(t.random.uniform(-0.9, 0.9) * static_cast<double>(dx)) / unit * unit;
      path.push_back({path.back().x + dx, path.back().y + dy});
    }
    const auto twice = [&](Ends ends) {
      const auto all = times_drawn(path, ends);
      return std::any_of(all.begin(), all.end(), [](const auto& p) { return p.second > 1; });
    };
    const auto all = times_drawn(path, Ends::diamond);
    std::map<int, int> columns;
    for (const auto& [p, times] : all) columns[p.first] += times;
    t.tally(twice(Ends::closed), twice(Ends::diamond), {double(path[1].x), double(path[1].y)});
    int expected = 0;
    for (const auto& [x, times] : columns) {
      t.require(x == expected++, "no gap", {double(x)});
      t.require(times == 1, "one pixel a column", {double(x), double(times)});
    }
  }
  const GridPoint p{100, 200}, q{70000, 30011};
  const kernels::PixelRect window{0, 0, 400, 400};
  t.price([&] { keep(drawn(p, q, window, Ends::closed)); },
          [&] { keep(drawn(p, q, window, Ends::diamond)); });
}

void clipped_line(Trial& t) {
  const kernels::PixelRect screen{0, 0, 640, 480};
  const auto seen = [&](std::int64_t x0, std::int64_t y0, std::int64_t x1, std::int64_t y1) {
    std::vector<Pixel> want;
    for (int x = 0; x < 640; ++x) {
      const Pixel p = nearest(x0, y0, x1, y1, x, false);
      if (p.second >= 0 && p.second < 480) want.push_back(p);
    }
    auto got = drawn(middle_of(x0, y0), middle_of(x1, y1), screen);
    std::sort(got.begin(), got.end());
    // The naive clip: from the rounded point where the line enters the screen to the one where it leaves it.
    auto naive = want.empty() ? want
                              : drawn(middle_of(want.front().first, want.front().second),
                                      middle_of(want.back().first, want.back().second), screen);
    std::sort(naive.begin(), naive.end());
    t.tally(naive != want, got != want, {double(x0), double(y0), double(x1), double(y1)});
  };
  seen(-1000000, 3, 1000000, 517);
  for (std::size_t n = t.samples(100, 10000); n-- > 0;) {
    const auto at = [&](double low, double high) {
      return static_cast<std::int64_t>(t.random.uniform(low, high));
    };
    const std::int64_t x0 = at(-1e6, -10), x1 = at(700, 1e6), rise = std::min<std::int64_t>(x1 - x0, 3000);
    const std::int64_t y0 = at(-1000, 1400);
    seen(x0, y0, x1, y0 + at(-static_cast<double>(rise), static_cast<double>(rise)));
  }
  t.price([&] { keep(drawn(middle_of(0, 260), middle_of(639, 260), screen)); },
          [&] { keep(drawn(middle_of(-1000000, 3), middle_of(1000000, 517), screen)); });
}

// Ink of a stripe: by distance to its middle clamped to a pixel, as smooth lines are often drawn, and by area.
void ink_of_wide_lines(Trial& t) {
  const kernels::PixelRect window{0, 0, 100, 100};
  const auto clamped = [&](const dvec2& p, const dvec2& q, double width) {
    const dvec2 along = (q - p) / kernels::norm(q - p);
    double sum = 0;
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 100; ++x) {
        const dvec2 e = dvec2(x + 0.5, y + 0.5) - p;
        const double at = kernels::dot(e, along), off = std::fabs(e.x * along.y - e.y * along.x);
        if (at >= 0 && at <= kernels::norm(q - p))
          sum += std::clamp(width / 2 - off + 0.5, 0.0, std::min(1.0, width));
      }
    return sum;
  };
  for (int step = 0; step < 90; ++step)
    for (const double width : {0.1, 0.5, 1.0, 2.5, 16.0}) {
      const double angle = step * 3.141592653589793 / 90;
      const GridPoint p{50 * line::grid + 17, 50 * line::grid + 99};
      const GridPoint q{p.x + std::llround(7000 * std::cos(angle)),
                        p.y + std::llround(7000 * std::sin(angle))};
      double sum = 0;
      line::exact_area(p, q, width, window, [&](const Step& s) { sum += s.coverage; });
      const Real want = exact([&] {
        const Real dx(static_cast<double>(q.x - p.x)), dy(static_cast<double>(q.y - p.y));
        return sqrt(dx * dx + dy * dy) * Real(width) / Real(double(line::grid));
      });
      const auto px = [](GridPoint g) {
        return dvec2(static_cast<double>(g.x), static_cast<double>(g.y)) / double(line::grid);
      };
      t.measure(std::fabs(clamped(px(p), px(q), width) / want.to_double() - 1),
                std::fabs(sum / want.to_double() - 1), {angle, width});
    }
  const GridPoint p = middle_of(3, 3), q = middle_of(90, 70);
  t.price(
      [&] {
        keep(clamped({3.5, 3.5}, {90.5, 70.5}, 1));
      },
      [&] {
        double sum = 0;
        line::exact_area(p, q, 1, window, [&](const Step& s) { sum += s.coverage; });
        keep(sum);
      });
}

// What the course's recursion would need: a frame for every pixel, and no end where a pixel never gets the colour.
struct Recursion {
  int width, height;
  std::vector<float>* pixels;
  std::size_t depth = 0, deepest = 0, calls = 0;
  static constexpr std::size_t stack = 20'000;  // frames: some 2 MB, more than a thread is sure to have
  bool overflows = false;

  void fill(int x, int y, float color, float boundary) {
    if (x < 0 || y < 0 || x >= width || y >= height || overflows) return;
    float& at = (*pixels)[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                          static_cast<std::size_t>(x)];
    if (!(at != color && at != boundary)) return;
    if (++depth > deepest) deepest = depth;
    if (depth >= stack) overflows = true;
    at = color;
    fill(x + 1, y, color, boundary), fill(x - 1, y, color, boundary);
    fill(x, y + 1, color, boundary), fill(x, y - 1, color, boundary);
    --depth;
  }
};

void large_region(Trial& t) {
  const int size = t.full() ? 4096 : 1024;
  const auto pixels = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  const auto judge = [&](std::vector<float> canvas, std::uint64_t want, float color) {
    const auto at = [&](int x, int y) {
      return canvas[static_cast<std::size_t>(y) * static_cast<std::size_t>(size) +
                    static_cast<std::size_t>(x)];
    };
    const auto inside = [&](int x, int y) { return !(at(x, y) == 1.0F); };
    const auto filled = fill::spans_from(size, size, 1, 1, fill::Connectivity::four, inside, [] {});
    Recursion naive{size, size, &canvas};
    naive.fill(1, 1, color, 1.0F);
    std::uint64_t colored = 0;
    for (const float v : canvas) colored += v == color ? 1 : 0;
    t.tally(naive.overflows || colored != want, filled.pixels != want, {double(color)});
    t.require(filled.tests <= 4 * filled.pixels, "some four looks a pixel");
    t.require(filled.deepest <= static_cast<std::size_t>(size), "memory of a row");
  };
  std::vector<float> canvas(pixels, 0.0F);
  judge(canvas, pixels, 0.5F);
  canvas[pixels / 2] = std::numeric_limits<float>::quiet_NaN();
  judge(canvas, pixels, std::numeric_limits<float>::quiet_NaN());
  // Half of the region has the fill's colour already.
  for (std::size_t i = 0; i < pixels; ++i) canvas[i] = i % 16 < 8 ? 0.0F : 0.5F;
  judge(canvas, pixels, 0.5F);
  std::vector<float> small(64 * 64, 0.0F);
  t.price(
      [&] {
        small.assign(small.size(), 0.0F);
        Recursion naive{64, 64, &small};
        naive.fill(1, 1, 0.5F, 1.0F);
      },
      [&] {
        small.assign(small.size(), 0.0F);
        keep(fill::spans_from(
            64, 64, 1, 1, fill::Connectivity::four,
            [&](int x, int y) { return small[static_cast<std::size_t>(y * 64 + x)] != 1.0F; }, [] {}));
      });
}

}  // namespace

std::vector<HardCase> lines() {
  return {
      {"LIN-01", "every octant, and lines between points of +-2^29", "the course's loop, with 32 bits",
       "line::bresenham", "rationals: the nearest pixel of each column", "the same pixels", "wrong lines", 0,
       every_octant},
      {"LIN-02", "slopes over 16384 pixels", "y += m in float", "line::dda", "rationals", "no wrong pixel",
       "wrong pixels", 0, accumulated_slope},
      {"LIN-04", "paths with ends on the diamonds' corners and edges, and shorter than a pixel",
       "segments from end pixel to end pixel", "line::bresenham, diamond ends", "counting",
       "no pixel twice, no gap", "paths with a pixel twice", 0, joints_of_a_path},
      {"LIN-05", "(-1e6, 3) to (1e6, 517) and others through a 640 x 480 screen",
       "drawn from where it enters, rounded", "line::bresenham", "rationals",
       "the pixels of the whole line that are seen", "wrong lines", 0, clipped_line},
      {"LIN-06", "stripes of width 0.1 to 16 at every second degree", "the distance from the middle, clamped",
       "line::exact_area", "MPFR: length times width", "total ink within 1e-12", "relative error of the ink",
       1e-12, ink_of_wide_lines},
      {"LIN-07", "a uniform picture, one with a NaN, one half of the fill's colour", "the course's recursion",
       "fill::spans_from", "counting", "all pixels, in the memory of a row", "wrong fills", 0, large_region},
  };
}

}  // namespace frustum::hard
