#include "nodes/kernels/sample_pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace frustum {
namespace {

using kernels::PatternKind;

struct Offsets {
  std::vector<std::uint16_t> x, y;
};
Offsets offsets(PatternKind kind, std::size_t n, int px = 0, int py = 0, std::uint64_t seed = 0) {
  Offsets o{std::vector<std::uint16_t>(n), std::vector<std::uint16_t>(n)};
  kernels::fill_sample_offsets(kind, seed, px, py, o.x, o.y);
  return o;
}

TEST(SampleGrid, HasTheExpectedCentres) {
  const auto one = offsets(PatternKind::grid, 1);
  EXPECT_EQ(one.x[0], 2048);
  EXPECT_EQ(one.y[0], 2048);
  const auto four = offsets(PatternKind::grid, 4);
  EXPECT_EQ(four.x, (std::vector<std::uint16_t>{1024, 3072, 1024, 3072}));
  EXPECT_EQ(four.y, (std::vector<std::uint16_t>{1024, 1024, 3072, 3072}));
  const auto six = offsets(PatternKind::grid, 6);
  EXPECT_EQ(six.x, (std::vector<std::uint16_t>{683, 2048, 3413, 683, 2048, 3413}));
  EXPECT_EQ(six.y, (std::vector<std::uint16_t>{1024, 1024, 1024, 3072, 3072, 3072}));
  const auto prime = kernels::grid_shape(7);
  EXPECT_EQ(prime.columns, 7);
  EXPECT_EQ(prime.rows, 1);
  EXPECT_EQ(kernels::grid_shape(12).columns, 4);
}

TEST(SamplePatterns, HaveNoDuplicatesAndStayInThePixel) {
  for (const auto kind : {PatternKind::grid, PatternKind::jittered, PatternKind::sobol})
    for (const std::size_t n : {1U, 2U, 3U, 5U, 7U, 16U, 37U, 64U, 100U, 256U, 1024U, 4096U})
      for (int pixel = 0; pixel < 4; ++pixel) {
        const auto o = offsets(kind, n, pixel, 3 * pixel, 11);
        std::set<std::pair<int, int>> distinct;
        for (std::size_t i = 0; i < n; ++i) {
          EXPECT_LT(o.x[i], 4096);
          EXPECT_LT(o.y[i], 4096);
          distinct.emplace(o.x[i], o.y[i]);
        }
        EXPECT_EQ(distinct.size(), n) << static_cast<int>(kind);
      }
}

// The (0,2) property: every dyadic rectangle of area 1/n holds one of n = 2^k points.
TEST(SobolPattern, StratifiesEveryDyadicRectangle) {
  for (int k = 0; k <= 8; ++k)
    for (int pixel = 0; pixel < 50; ++pixel) {
      const std::size_t n = std::size_t{1} << k;
      const auto o = offsets(PatternKind::sobol, n, pixel, 7 * pixel, 5);
      for (int a = 0; a <= k; ++a) {
        std::set<int> cells;
        for (std::size_t i = 0; i < n; ++i)
          cells.insert((o.x[i] >> (12 - a)) << (k - a) | o.y[i] >> (12 - (k - a)));
        EXPECT_EQ(cells.size(), n) << k << " " << a;
      }
    }
}

TEST(SobolPattern, DiffersBetweenPixelsAndIsUniformOverThem) {
  std::set<std::vector<std::uint16_t>> distinct;
  double mean = 0;
  for (int py = 0; py < 64; ++py)
    for (int px = 0; px < 64; ++px) {
      const auto o = offsets(PatternKind::sobol, 1, px, py);
      mean += o.x[0];
      auto sixteen = offsets(PatternKind::sobol, 16, px, py);
      sixteen.x.insert(sixteen.x.end(), sixteen.y.begin(), sixteen.y.end());
      distinct.insert(sixteen.x);
    }
  EXPECT_EQ(distinct.size(), 4096U);
  EXPECT_NEAR(mean / 4096, 2047.5, 5 * 4096 * std::sqrt(1.0 / 12 / 4096));
}

// Warnock's formula for the square of the L2 star discrepancy, with points at the middle of their step.
double discrepancy2(const Offsets& o) {
  const auto n = static_cast<double>(o.x.size());
  const auto at = [](std::uint16_t v) { return (v + 0.5) / 4096; };
  double pairs = 0, singles = 0;
  for (std::size_t i = 0; i < o.x.size(); ++i) {
    singles += (1 - at(o.x[i]) * at(o.x[i])) * (1 - at(o.y[i]) * at(o.y[i]));
    for (std::size_t j = 0; j < o.x.size(); ++j)
      pairs += (1 - at(std::max(o.x[i], o.x[j]))) * (1 - at(std::max(o.y[i], o.y[j])));
  }
  return 1.0 / 9 - singles / (2 * n) + pairs / (n * n);
}

TEST(SamplePatterns, RankByDiscrepancyAsTheyShould) {
  constexpr std::size_t n = 64;
  double sobol = 0, jittered = 0, random = 0;
  constexpr int pixels = 40;
  for (int p = 0; p < pixels; ++p) {
    sobol += discrepancy2(offsets(PatternKind::sobol, n, p, 1));
    jittered += discrepancy2(offsets(PatternKind::jittered, n, p, 1));
    Offsets o{std::vector<std::uint16_t>(n), std::vector<std::uint16_t>(n)};
    for (std::uint32_t i = 0; i < n; ++i) {
      const auto r = kernels::random_bits(1, p, 0, i, kernels::Dimension("independent"));
      o.x[i] = static_cast<std::uint16_t>(r[0] >> 20), o.y[i] = static_cast<std::uint16_t>(r[1] >> 20);
    }
    random += discrepancy2(o);
  }
  // Independent points have mean (1/4 - 1/9) / n; the others are better by at least these factors.
  EXPECT_NEAR(random / pixels, (1.0 / 4 - 1.0 / 9) / n, 0.35 * (1.0 / 4 - 1.0 / 9) / n);
  EXPECT_LT(jittered, random / 3);
  EXPECT_LT(sobol, jittered / 2);
}

}  // namespace
}  // namespace frustum
