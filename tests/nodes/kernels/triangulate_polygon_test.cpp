#include "nodes/kernels/triangulate_polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

__extension__ using int128 = __int128;
using Triangles = std::vector<std::array<std::uint32_t, 3>>;
using Polygon = std::vector<glm::dvec2>;

// Twice the area of a triangle of coordinates that are integers times 2^-53 and below 2^10.
int128 exact_area(const Polygon& p, const std::array<std::uint32_t, 3>& t) {
  const auto integer = [](double x) { return static_cast<int128>(x * 0x1p53); };
  const auto x = [&](int i) { return integer(p[t[static_cast<std::size_t>(i)]].x); };
  const auto y = [&](int i) { return integer(p[t[static_cast<std::size_t>(i)]].y); };
  return (x(1) - x(0)) * (y(2) - y(0)) - (y(1) - y(0)) * (x(2) - x(0));
}

// Whether the triangles' directed edges, each against its opposite, leave exactly the outline.
testing::AssertionResult bounds_the_outline(std::size_t n, const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  const auto count = [&](std::uint32_t a, std::uint32_t b, int sign) {
    if (a != b) edges[std::minmax(a, b)] += a < b ? sign : -sign;
  };
  for (const auto& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] >= n) return testing::AssertionFailure() << "corner " << t[k];
      count(t[k], t[(k + 1) % 3], 1);
    }
  for (std::uint32_t i = 0; i < n; ++i) count(i, (i + 1) % static_cast<std::uint32_t>(n), -1);
  for (const auto& [edge, times] : edges)
    if (times != 0)
      return testing::AssertionFailure()
             << edge.first << "-" << edge.second << " is left over " << times << " times";
  return testing::AssertionSuccess();
}

enum class Flat { none, some };

// Triangles whose boundaries sum to the outline and of which none is clockwise cover each point as often as
// the outline winds around it.
void expect_tiled(const Polygon& p, Flat flat = Flat::none) {
  Triangles triangles;
  EXPECT_TRUE(kernels::triangulate_polygon(p, triangles));
  ASSERT_EQ(triangles.size(), p.size() - 2);
  EXPECT_TRUE(bounds_the_outline(p.size(), triangles));
  std::size_t clockwise = 0, flats = 0;
  for (const auto& t : triangles) {
    const int128 area = exact_area(p, t);
    clockwise += area < 0, flats += area == 0;
  }
  EXPECT_EQ(clockwise, 0u);
  if (flat == Flat::none) {
    EXPECT_EQ(flats, 0u);
  }
}

// Cells of a grid joined into a tree: cells side by side that are not joined have a slit between them, so
// that the outline goes along it twice, touches itself at corners and surrounds holes.
class Cells {
 public:
  Cells(int size, int wanted, test::Random& random)
      : size_(size), open_(static_cast<std::size_t>(size * size)) {
    std::vector<int> in{size * (size / 2) + size / 2};
    std::vector<char> used(open_.size());
    used[static_cast<std::size_t>(in[0])] = 1;
    for (int tries = 0; static_cast<int>(in.size()) < wanted && tries < 100 * wanted; ++tries) {
      const int from = in[random.below(in.size())], side = static_cast<int>(random.below(4));
      const int to = neighbour(from, side);
      if (to < 0 || used[static_cast<std::size_t>(to)]) continue;
      used[static_cast<std::size_t>(to)] = 1;
      join(from, side), join(to, (side + 2) % 4);
      in.push_back(to);
    }
    first_ = in[0];
    while (open(first_, 0)) first_ = neighbour(first_, 0);
  }

  // Counter-clockwise, with a corner at every unit.
  Polygon outline() const {
    Polygon p;
    int cell = first_, side = 0;
    do {
      if (open(cell, side)) {
        cell = neighbour(cell, side), side = (side + 3) % 4;
      } else {
        p.emplace_back(cell % size_ + (side == 1 || side == 2), cell / size_ + (side == 2 || side == 3));
        side = (side + 1) % 4;
      }
    } while (cell != first_ || side != 0);
    return p;
  }

 private:
  bool open(int cell, int side) const { return open_[static_cast<std::size_t>(cell)] >> side & 1; }
  void join(int cell, int side) {
    auto& sides = open_[static_cast<std::size_t>(cell)];
    sides = static_cast<std::uint8_t>(sides | 1 << side);
  }
  int neighbour(int cell, int side) const {  // sides: below, right, above, left
    const int x = cell % size_ + (side == 1) - (side == 3), y = cell / size_ + (side == 2) - (side == 0);
    return x < 0 || y < 0 || x >= size_ || y >= size_ ? -1 : y * size_ + x;
  }
  int size_, first_ = 0;
  std::vector<std::uint8_t> open_;
};

// The same seen from elsewhere: by a matrix of determinant 1, from another corner on, some corners repeated,
// some on straight edges left out.
Polygon changed(const Polygon& p, test::Random& random, bool repeats) {
  const double a = static_cast<double>(random.below(5)) - 2, b = static_cast<double>(random.below(5)) - 2;
  const std::size_t n = p.size(), first = random.below(n);
  Polygon out;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec2 q = p[(first + i) % n], before = p[(first + i + n - 1) % n],
                     after = p[(first + i + 1) % n];
    const bool straight = after - q == q - before;
    if (straight && random.below(3) == 0 && out.size() + n - i > 4) continue;
    const std::size_t times = repeats && random.below(8) == 0 ? 2 + random.below(3) : 1;
    out.insert(out.end(), times, {q.x + a * q.y, b * q.x + (a * b + 1) * q.y});
  }
  return out;
}

TEST(TriangulatePolygon, TilesOutlinesWithSlitsHolesAndTouchingCorners) {
  test::Random random(1);
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    const int size = 2 + static_cast<int>(random.below(12));
    const Polygon p =
        Cells(size, 1 + static_cast<int>(random.below(static_cast<std::size_t>(size * size))), random)
            .outline();
    expect_tiled(changed(p, random, i % 2 == 0), Flat::some);
    if (testing::Test::HasFailure()) break;
  }
}

// The upper and the lower of two staircases with many corners at one x and many on straight edges.
TEST(TriangulatePolygon, GivesEveryTriangleOfASimplePolygonAnArea) {
  test::Random random(2);
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    const int columns = 1 + static_cast<int>(random.below(30));
    Polygon lower, upper;
    for (int x = 0; x <= columns; ++x) {
      const double low = static_cast<double>(random.below(4)),
                   high = 4 + static_cast<double>(random.below(4));
      lower.emplace_back(x, low), upper.emplace_back(x, high);
      if (x % columns != 0 && random.below(2) == 0)
        lower.emplace_back(x, static_cast<double>(random.below(4)));
      if (x % columns != 0 && random.below(2) == 0)
        upper.emplace_back(x, 4 + static_cast<double>(random.below(4)));
      for (Polygon* side : {&lower, &upper})
        if (side->size() > 1 && side->back() == (*side)[side->size() - 2]) side->pop_back();
    }
    lower.insert(lower.end(), upper.rbegin(), upper.rend());
    expect_tiled(changed(lower, random, false));
    if (testing::Test::HasFailure()) break;
  }
}

Polygon star(std::size_t n, test::Random& random) {
  Polygon p;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    const double radius = random.uniform(0.2, 1);
    p.emplace_back(std::floor(0x1p50 * radius * std::cos(angle)) * 0x1p-50,
                   std::floor(0x1p50 * radius * std::sin(angle)) * 0x1p-50);
  }
  return p;
}

// n corners, teeth upwards from a thin back.
Polygon comb(std::size_t n) {
  Polygon p{{0, -1}, {static_cast<double>(n - 3), -1}};
  for (std::size_t i = n - 2; i-- > 0;) p.emplace_back(static_cast<double>(i), i % 2 == 0 ? 0 : 100);
  return p;
}

// A band between two turns of a spiral with n corners, from the inside out and back.
Polygon spiral(std::size_t n) {
  Polygon p;
  const auto add = [&](double t, double in) {
    const double radius = (t - in) * 0x1p-8, angle = t * std::numbers::pi / 32;
    p.emplace_back(std::floor(0x1p30 * radius * std::cos(angle)) * 0x1p-30,
                   std::floor(0x1p30 * radius * std::sin(angle)) * 0x1p-30);
  };
  const std::size_t half = n / 2;
  for (std::size_t i = 0; i < half; ++i) add(static_cast<double>(i + 100), 0);
  for (std::size_t i = half; i-- > 0;) add(static_cast<double>(i + 100), 20);
  return p;
}

TEST(TriangulatePolygon, TilesStarsCombsAndSpiralsOfAnySize) {
  test::Random random(3);
  for (const std::size_t n : {5u, 8u, 100u, 5000u, 40000u}) {
    SCOPED_TRACE(n);
    expect_tiled(star(n, random));
    expect_tiled(comb(n));
    expect_tiled(spiral(n + n % 2));
  }
}

// Whether every corner of a chain from left to right lies strictly on that side of another with the same ends.
bool lies_beside(const Polygon& chain, const Polygon& other, int side) {
  std::size_t e = 0;
  for (std::size_t i = 1; i + 1 < chain.size(); ++i) {
    while (other[e + 1].x < chain[i].x) ++e;
    const int128 area = exact_area({other[e], other[e + 1], chain[i]}, {0, 1, 2});
    if (side > 0 ? area <= 0 : area >= 0) return false;
  }
  return true;
}

// Slivers along y = x, a few ulps wide.
TEST(TriangulatePolygon, IsExactWhereRoundedSignsAreWrong) {
  test::Random random(4);
  int tiled = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    Polygon lower{{0.5, 0.5}}, upper = lower;
    const auto add = [&](double x) {
      const double ulp = std::nextafter(x, 100) - x, off = static_cast<double>(random.below(4)) * ulp;
      if (random.below(2) == 0)
        lower.emplace_back(x, x - off);
      else
        upper.emplace_back(x, x + off);
    };
    for (std::size_t k = 1, n = 1 + random.below(20); k < n; ++k) add(0.5 + static_cast<double>(k) * 0x1p-53);
    for (const double x : {0.7, 1.5, 3.0, 6.0, 12.0, 24.0}) add(x);
    lower.emplace_back(48, 48), upper.emplace_back(48, 48);
    if (!lies_beside(lower, upper, -1) || !lies_beside(upper, lower, 1)) continue;
    lower.insert(lower.end(), upper.rbegin() + 1, upper.rend() - 1);
    expect_tiled(lower);
    ++tiled;
    if (testing::Test::HasFailure()) break;
  }
  EXPECT_GT(tiled, 1000);
}

TEST(TriangulatePolygon, KeepsTheSignedAreaOfOutlinesThatCrossThemselves) {
  test::Random random(5);
  int tiled = 0;
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    Polygon p(3 + random.below(12));
    for (auto& q : p) q = {static_cast<double>(random.below(6)), static_cast<double>(random.below(6))};
    Triangles triangles{{7, 8, 9}};
    const bool good = kernels::triangulate_polygon(p, triangles);
    ASSERT_EQ(triangles.front(), (std::array<std::uint32_t, 3>{7, 8, 9}));
    triangles.erase(triangles.begin());
    ASSERT_EQ(triangles.size(), p.size() - 2);
    ASSERT_TRUE(bounds_the_outline(p.size(), triangles));
    bool clockwise = false, area = false;
    for (const auto& t : triangles) clockwise |= exact_area(p, t)<0, area |= exact_area(p, t)> 0;
    ASSERT_EQ(good, area && !clockwise);
    tiled += good;
  }
  EXPECT_GT(tiled, 1000);
  EXPECT_LT(tiled, 19000);
}

TEST(TriangulatePolygon, SaysThatWhatHasNoInsideIsNotTiled) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const Polygon bad[] = {{{0, 0}, {1, 0}, {2, 0}, {3, 0}},            // on a line
                         {{0, 0}, {0, 0}, {0, 0}, {0, 0}, {0, 0}},    // one point
                         {{0, 0}, {1, 1}, {0, 0}, {1, 1}},            // there and back
                         {{0, 0}, {0, 1}, {1, 1}, {1, 0}},            // clockwise
                         {{0, 0}, {1, 1}, {1, 0}, {0, 1}},            // a bow tie
                         {{0, 0}, {1, 0}, {nan, 1}, {0, 1}, {0, 0}},  //
                         {{0, 0}, {1, 0}, {1, inf}, {0, 1}}};
  for (const Polygon& p : bad) {
    Triangles triangles;
    EXPECT_FALSE(kernels::triangulate_polygon(p, triangles));
    EXPECT_EQ(triangles.size(), p.size() - 2);
    EXPECT_TRUE(bounds_the_outline(p.size(), triangles));
  }
}

}  // namespace
}  // namespace frustum
