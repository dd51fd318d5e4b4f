#include "nodes/kernels/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using kernels::Filter;
using kernels::FilterCurve;
using kernels::FilterKind;

const FilterKind kinds[] = {FilterKind::box, FilterKind::bartlett, FilterKind::gaussian,
                            FilterKind::mitchell};

TEST(FilterCurves, HaveTheValuesOfTheirFormulas) {
  const FilterCurve<double> tent({.kind = FilterKind::bartlett, .radius = 2});
  EXPECT_EQ(tent(0), 1);
  EXPECT_EQ(tent(0.5), 0.75);
  EXPECT_EQ(tent(-1.5), 0.25);
  const FilterCurve<double> mitchell({.kind = FilterKind::mitchell, .radius = 2});
  EXPECT_NEAR(mitchell(0), 8.0 / 9, 1e-15);   // (6 - 2/3) / 6
  EXPECT_NEAR(mitchell(1), 1.0 / 18, 1e-15);  // b / 6
  EXPECT_NEAR(mitchell(-1.5), -0.03472222222222222, 1e-15);
  const FilterCurve<double> catmull({.kind = FilterKind::mitchell, .radius = 2, .b = 0, .c = 0.5});
  EXPECT_EQ(catmull(0), 1);
  EXPECT_NEAR(catmull(1), 0, 1e-15);
  EXPECT_NEAR(catmull(0.5), 0.5625, 1e-15);
  const FilterCurve<double> gaussian({.kind = FilterKind::gaussian, .radius = 1.5, .sigma = 0.5});
  EXPECT_NEAR(gaussian(0.5), std::exp(-0.5) - std::exp(-4.5), 1e-15);
}

TEST(FilterCurves, AreEvenContinuousAndZeroOutside) {
  for (const auto kind : kinds)
    for (const double radius : {0.3, 0.5, 1.0, 1.7, 4.0}) {
      const FilterCurve<float> f({.kind = kind, .radius = radius});
      const auto r = static_cast<float>(radius);
      EXPECT_EQ(f(r), 0);
      EXPECT_EQ(f(-std::nextafter(r, 10.0F)), 0);
      EXPECT_EQ(f(std::numeric_limits<float>::quiet_NaN()), 0);
      EXPECT_EQ(f(std::numeric_limits<float>::infinity()), 0);
      float before = f(0);
      for (int i = 1; i < 1000; ++i) {
        const float x = r * static_cast<float>(i) / 1000;
        EXPECT_EQ(f(x), f(-x));
        EXPECT_LE(std::fabs(f(x) - before), 0.01F);
        before = f(x);
      }
    }
  EXPECT_EQ(FilterCurve<float>({.kind = FilterKind::box, .radius = 0.5})(-0.5F), 1);
}

// Mitchell's cubics sum to 1 over integer shifts for every b and c; so do boxes and tents of whole radius.
TEST(FilterCurves, PartitionUnityOverIntegerShifts) {
  test::Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const double phase = random.uniform(0, 1);
    const Filter mitchell{
        .kind = FilterKind::mitchell, .radius = 2, .b = random.uniform(), .c = random.uniform()};
    const FilterCurve<double> m(mitchell);
    double sum = 0;
    for (int k = -3; k <= 3; ++k) sum += m(phase + k);
    EXPECT_NEAR(sum, 1, 40 * 0x1p-53);  // four cubics of 7 roundings each, terms up to 3
    for (int radius = 1; radius <= 8; ++radius) {
      const FilterCurve<double> tent({.kind = FilterKind::bartlett, .radius = static_cast<double>(radius)});
      double total = 0;
      for (int k = -radius - 1; k <= radius; ++k) total += tent(phase + k);
      EXPECT_NEAR(total, radius, 2 * radius * radius * 0x1p-53);
    }
  }
}

// SMP-06: added up in order, the weights make 1; at dyadic phases of a dyadic tent exactly so.
TEST(FilterWeights, SumToOne) {
  test::Random random(2);
  for (const auto kind : kinds)
    for (int i = 0; i < 2000; ++i) {
      const double radius = random.uniform(0.5, 9);
      const FilterCurve<float> curve({.kind = kind, .radius = radius});
      std::vector<float> w(kernels::filter_tap_count(radius));
      const auto reach = static_cast<float>(std::ceil(radius));
      kernels::fill_filter_weights<float>(curve, static_cast<float>(random.uniform(-1, 0)) - reach + 1, w);
      double sum = 0;
      for (const float x : w) sum += static_cast<double>(x);
      EXPECT_NEAR(sum, 1, 0x1p-24) << static_cast<int>(kind) << " radius " << radius;
    }
  for (const int radius : {1, 2, 4, 8})
    for (int phase = 0; phase < 256; ++phase) {
      const FilterCurve<float> tent({.kind = FilterKind::bartlett, .radius = static_cast<double>(radius)});
      std::vector<float> w(kernels::filter_tap_count(radius));
      kernels::fill_filter_weights<float>(
          tent, static_cast<float>(phase) * 0x1p-8F - static_cast<float>(radius), w);
      float sum = 0;
      for (const float x : w) sum += x;
      EXPECT_EQ(sum, 1);
    }
}

TEST(FilterWeights, StayZeroWhereNothingIsCovered) {
  std::vector<float> w(3, 9.0F);
  kernels::fill_filter_weights<float>(FilterCurve<float>({.kind = FilterKind::box, .radius = 0.5}), 5, w);
  EXPECT_EQ(w, (std::vector<float>{0, 0, 0}));
}

}  // namespace
}  // namespace frustum
