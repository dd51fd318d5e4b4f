#include "nodes/kernels/sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using test::Random;
using test::ulps;

// SMP-01: a float sum of ones stops at 2^24.
TEST(CompensatedSum, DoesNotStagnate) {
  kernels::CompensatedSum<float> ones, tenths;
  float plain = 0;
  for (int i = 0; i < 20000000; ++i) ones.add(1), plain += 1;
  for (int i = 0; i < 1000000; ++i) tenths.add(0.1F);
  EXPECT_EQ(ones.value(), 2e7F);
  EXPECT_EQ(plain, 0x1p24F);
  EXPECT_EQ(tenths.value(), static_cast<float>(1e6 * static_cast<double>(0.1F)));
}

TEST(CompensatedSum, PassesInfinitiesAndNaNOn) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  kernels::CompensatedSum<double> up, undefined;
  up.add(inf), up.add(1);
  undefined.add(inf), undefined.add(-inf);
  EXPECT_EQ(up.value(), inf);
  EXPECT_TRUE(std::isnan(undefined.value()));
}

// SMP-07, at its size.
TEST(ExactSum, IsTheSameForEveryOrderAndRoundedOnce) {
  Random random(1);
  std::vector<double> terms(1000000);
  __extension__ using quad = __float128;
  quad oracle = 0;
  for (auto& x : terms) {
    x = std::exp(random.uniform(-5, 20)) * (random.bits() % 2 == 0 ? 1 : -1);
    oracle += static_cast<quad>(x);
  }
  const auto total = [](const std::vector<double>& v) {
    kernels::ExactSum sum;
    for (const double x : v) sum.add(x);
    return sum.value();
  };
  const double first = total(terms);
  EXPECT_LE(ulps(first, static_cast<long double>(oracle)), 0.5001);
  const double plain = std::accumulate(terms.begin(), terms.end(), 0.0);
  std::sort(terms.begin(), terms.end());
  EXPECT_EQ(total(terms), first);
  std::reverse(terms.begin(), terms.end());
  EXPECT_EQ(total(terms), first);
  EXPECT_NE(std::accumulate(terms.begin(), terms.end(), 0.0), plain);  // the plain sum depends on it
}

TEST(ExactSum, KeepsWhatCancellationLeaves) {
  kernels::ExactSum sum;
  for (const double x : {1e300, 1.0, 1e-300, -1e300, -1.0}) sum.add(x);
  EXPECT_EQ(sum.value(), 1e-300);
  kernels::ExactSum tie;
  for (const double x : {1.0, 0x1p-53, 0x1p-200}) tie.add(x);
  EXPECT_EQ(tie.value(), 1 + 0x1p-52);  // half an ulp and a little more rounds up
}

TEST(PairwiseSum, ErrsByTheLogarithmOfTheCount) {
  Random random(2);
  for (const std::size_t n : {0U, 1U, 63U, 64U, 65U, 1000U, 300001U}) {
    std::vector<float> terms(n);
    double oracle = 0;
    for (auto& x : terms) {
      x = static_cast<float>(random.uniform());
      oracle += static_cast<double>(x);
    }
    const double bound = (64 + std::log2(static_cast<double>(n) / 64 + 2)) * 0x1p-24 * oracle;
    EXPECT_NEAR(kernels::pairwise_sum<float>(terms), oracle, bound);
  }
}

// SMP-04: E[x^2] - E[x]^2 in float is off by seven orders of magnitude here.
TEST(Moments, KeepTheVarianceOfALargeMeanAndMerge) {
  Random random(3);
  kernels::Moments whole, parts[7];
  std::vector<double> values;
  long double mean = 0;
  for (int i = 0; i < 100000; ++i) {
    const double x = 1e4 + random.uniform(-0.1, 0.1);
    values.push_back(x);
    mean += x;
    whole.add(x);
    parts[i % 7].add(x);
  }
  mean /= 100000;
  long double variance = 0;
  for (const double x : values) variance += (x - mean) * (x - mean);
  variance /= 100000;
  kernels::Moments merged;
  for (const auto& p : parts) merged = merged.merged(p);
  // kappa = sqrt(1 + mean^2 / variance) = 1.7e5; n kappa u would allow 2e-6.
  EXPECT_NEAR(whole.variance(), static_cast<double>(variance), 1e-9 * static_cast<double>(variance));
  EXPECT_NEAR(merged.variance(), static_cast<double>(variance), 1e-9 * static_cast<double>(variance));
  EXPECT_EQ(merged.count, 100000U);
  EXPECT_EQ(kernels::Moments{}.variance(), 0);
}

}  // namespace
}  // namespace frustum
