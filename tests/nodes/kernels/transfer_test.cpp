#include "nodes/kernels/transfer.h"

#include "nodes/kernels/simd/transfer.h"
#include "tests/support/simd_targets.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <vector>

namespace frustum::kernels {
namespace {

constexpr Curve curves[] = {Curve::linear, Curve::srgb, Curve::rec709, Curve::adobe_rgb};

// The standards' formulas, in 80 bits.
long double encoded(Curve c, long double v) {
  const CurveShape s = shape_of(c);
  const long double a = std::fabs(v);
  const long double e =
      c == Curve::linear ? a
      : a <= static_cast<long double>(s.knee)
          ? static_cast<long double>(s.slope) * a
          : static_cast<long double>(s.scale) * std::pow(a, 1 / static_cast<long double>(s.gamma)) -
                static_cast<long double>(s.scale - 1);
  return v < 0 ? -e : e;
}

template <class R>
double worst_relative(Curve c, bool back) {
  double worst = 0;
  for (double x = 1e-6; x < 100; x *= 1.0007) {
    const R v = static_cast<R>(x);
    // Decoding is compared with the value whose exact code was given.
    const long double want = back ? static_cast<long double>(v) : encoded(c, static_cast<long double>(v));
    const R got = back ? decode(c, static_cast<R>(encoded(c, static_cast<long double>(v)))) : encode(c, v);
    worst = std::max(worst, static_cast<double>(std::fabs((static_cast<long double>(got) - want) / want)));
  }
  return worst;
}

TEST(Transfer, HasTheErrorThatIsStated) {
  for (const Curve c : curves) {
    EXPECT_LT(worst_relative<float>(c, false), 4e-7) << static_cast<int>(c);
    EXPECT_LT(worst_relative<double>(c, false), 1e-15) << static_cast<int>(c);
    // One rounding of the code is amplified by the curve's slope, at most 2.4.
    EXPECT_LT(worst_relative<float>(c, true), 6e-7) << static_cast<int>(c);
  }
}

TEST(Transfer, MeetsTheStandardsAtTheirPoints) {
  EXPECT_EQ(encode(Curve::srgb, 0.0), 0);
  EXPECT_NEAR(encode(Curve::srgb, 1.0), 1, 2e-16);
  EXPECT_NEAR(encode(Curve::srgb, 0.5), 0.735356983052, 1e-12);  // 1.055 * 0.5^(1/2.4) - 0.055
  EXPECT_NEAR(decode(Curve::srgb, 0.5), 0.214041140482, 1e-12);  // ((0.5 + 0.055) / 1.055)^2.4
  EXPECT_NEAR(encode(Curve::srgb, 0.0031308), 0.04044993600, 1e-10);
  EXPECT_NEAR(encode(Curve::rec709, 0.018), 0.081, 1e-12);
  EXPECT_NEAR(encode(Curve::rec709, 1.0), 1, 1e-14);
  EXPECT_NEAR(encode(Curve::adobe_rgb, 0.25), 0.532401354084, 1e-12);  // 0.25^(256/563)
}

TEST(Transfer, BlackAndWhiteAreFixedPoints) {
  for (const Curve c : curves)
    for (const double v : {0.0, 1.0, -1.0}) {
      EXPECT_EQ(encode(c, v), v) << static_cast<int>(c);
      EXPECT_EQ(decode(c, v), v) << static_cast<int>(c);
      EXPECT_EQ(encode(c, static_cast<float>(v)), static_cast<float>(v)) << static_cast<int>(c);
      EXPECT_EQ(decode(c, static_cast<float>(v)), static_cast<float>(v)) << static_cast<int>(c);
    }
}

TEST(Transfer, CurvesAreOddAndPassWhatIsNotFinite) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const Curve c : curves) {
    EXPECT_EQ(encode(c, -0.3), -encode(c, 0.3));
    EXPECT_EQ(decode(c, -0.01), -decode(c, 0.01));
    EXPECT_TRUE(std::signbit(encode(c, -0.0)));
    EXPECT_EQ(encode(c, inf), inf);
    EXPECT_EQ(decode(c, -inf), -inf);
    EXPECT_TRUE(std::isnan(encode(c, std::nan(""))) && std::isnan(decode(c, std::nan(""))));
  }
}

TEST(Transfer, Rec709IsSmoothAtItsKnee) {
  const CurveShape s = shape_of(Curve::rec709);
  const double h = 1e-6, below = encode(Curve::rec709, s.knee - h), at = encode(Curve::rec709, s.knee),
               above = encode(Curve::rec709, s.knee + h);
  EXPECT_NEAR((above - at) / h, (at - below) / h, 1e-4);
}

class TransferOnTarget : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Simd, TransferOnTarget, test::every_target(), test::target_name);

TEST_P(TransferOnTarget, HasTheScalarBits) {
  test::Random random(7);
  for (const Curve from : curves)
    for (const Curve to : curves)
      for (const int kind : {0, 1, 2}) {
        ColorMap map{.from = from,
                     .to = to,
                     .same_primaries = kind == 1,
                     .keeps_grey = kind == 2,
                     .matrix = {0.6, 0.3, 0.1, -0.05, 1.1, -0.05, 0.02, 0.08, 0.9}};
        for (const std::size_t n : {1u, 7u, 64u, 301u}) {
          std::vector<float> a[3], b[3];
          for (int k = 0; k < 3; ++k) {
            for (std::size_t i = 0; i < n; ++i)
              a[k].push_back(static_cast<float>(i % 3 != 0 ? random.uniform() : random.magnitude(-30, 10)));
            if (n > 6) a[k][3] = std::numeric_limits<float>::infinity(), a[k][5] = -0.0f, a[k][6] = 1e-40f;
            if (n > 6 && k == 1) a[k][4] = std::numeric_limits<float>::quiet_NaN();
            b[k] = a[k];
          }
          convert_colors(map, a[0].data(), a[1].data(), a[2].data(), n);
          simd::convert_colors(map, b[0].data(), b[1].data(), b[2].data(), n);
          for (int k = 0; k < 3; ++k)
            for (std::size_t i = 0; i < n; ++i)
              ASSERT_TRUE(std::bit_cast<std::uint32_t>(a[k][i]) == std::bit_cast<std::uint32_t>(b[k][i]) ||
                          (std::isnan(a[k][i]) && std::isnan(b[k][i])))
                  << a[k][i] << " " << b[k][i];
        }
      }
}

}  // namespace
}  // namespace frustum::kernels
