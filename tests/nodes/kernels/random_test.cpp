#include "nodes/kernels/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

namespace frustum {
namespace {

using kernels::Dimension;
using kernels::Random4;

// kat_vectors of the authors' Random123 1.14.
TEST(Philox, GivesTheKnownAnswers) {
  EXPECT_EQ(kernels::philox({0, 0, 0, 0}, {0, 0}), (Random4{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(kernels::philox({~0U, ~0U, ~0U, ~0U}, {~0U, ~0U}),
            (Random4{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(kernels::philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Random4{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// SMP-02: u32 max * 2^-32 is 1 in float.
TEST(UniformNumbers, NeverReachOne) {
  for (std::uint32_t i = 0; i < 100000; ++i) {
    const std::uint32_t top = ~i;
    EXPECT_LT(kernels::uniform_from<float>(top, ~0U), 1.0F);
    EXPECT_LT(kernels::uniform_from<double>(~0U, top), 1.0);
  }
  EXPECT_EQ(static_cast<float>(~0U) * 0x1p-32F, 1.0F);  // the plain form
  EXPECT_EQ(kernels::uniform_from<float>(0, 0), 0);
  EXPECT_EQ(kernels::uniform_from<double>(0x80000000, 0), 0.5);
}

TEST(UniformNumbers, FillTheUnitSquareEvenly) {
  constexpr int cells = 16, n = 1 << 16;
  std::vector<int> hits(cells * cells);
  double mean = 0;
  for (int i = 0; i < n; ++i) {
    const auto p = kernels::random_uniform2<double>(7, i % 256, i / 256, 3, Dimension("test"));
    ++hits[static_cast<std::size_t>(static_cast<int>(p.x * cells) * cells + static_cast<int>(p.y * cells))];
    mean += p.x;
  }
  double chi2 = 0;
  const double expected = static_cast<double>(n) / (cells * cells);
  for (const int h : hits) chi2 += (h - expected) * (h - expected) / expected;
  // 255 degrees of freedom: mean 255, deviation sqrt(510) = 22.6; five deviations to each side.
  EXPECT_GT(chi2, 142);
  EXPECT_LT(chi2, 368);
  EXPECT_NEAR(mean / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
}

TEST(RandomBits, DifferInEveryCoordinate) {
  std::set<Random4> seen;
  for (const std::uint64_t seed : {0ULL, 1ULL, 1ULL << 32})
    for (const int x : {-1, 0, 1})
      for (const int y : {-1, 0, 1})
        for (const std::uint32_t s : {0U, 1U})
          for (const auto d : {Dimension("lens"), Dimension("light"), Dimension("light").at(1)})
            seen.insert(kernels::random_bits(seed, x, y, s, d));
  EXPECT_EQ(seen.size(), 3U * 3 * 3 * 2 * 3);
}

}  // namespace
}  // namespace frustum
