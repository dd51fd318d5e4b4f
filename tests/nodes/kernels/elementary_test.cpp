#include "nodes/kernels/elementary.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using test::Random;
using test::ulps;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <class R>
class Elementary : public testing::Test {
 public:
  static constexpr bool is_double = sizeof(R) == 8;
  // The bounds that elementary.h states. Float: one rounding of a double result.
  static constexpr double bound(double of_double) { return is_double ? of_double : 0.502; }

  template <class F, class Oracle, class Input>
  static void expect_within(double bound, F f, Oracle oracle, Input input) {
    double worst = 0;
    R witness = 0;
    for (int i = 0; i < 100000; ++i) {
      const R x = static_cast<R>(input());
      const double error = ulps<R>(f(x), oracle(static_cast<long double>(x)));
      if (!(error <= worst)) worst = error, witness = x;
    }
    EXPECT_LE(worst, bound) << "at " << std::hexfloat << witness;
  }
};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Elementary, Reals);

TYPED_TEST(Elementary, ExponentialsStayWithinTheirBound) {
  using R = TypeParam;
  Random random(1);
  const double top = this->is_double ? 709 : 88, bottom = this->is_double ? -745 : -103;
  const auto exp = [](R x) { return kernels::exp(x); };
  const auto exp2 = [](R x) { return kernels::exp2(x); };
  this->expect_within(this->bound(0.95), exp, expl, [&] { return random.uniform(bottom, top); });
  this->expect_within(this->bound(0.95), exp, expl, [&] { return random.magnitude(-60, 1); });
  this->expect_within(this->bound(0.95), exp2, exp2l,
                      [&] { return random.uniform(bottom * 1.4427, top * 1.4427); });
}

TYPED_TEST(Elementary, LogarithmsStayWithinTheirBound) {
  using R = TypeParam;
  Random random(2);
  const double range = this->is_double ? 1022 : 126;
  const auto log = [](R x) { return kernels::log(x); };
  const auto log2 = [](R x) { return kernels::log2(x); };
  const auto wide = [&] { return std::fabs(random.magnitude(-range, range)); };
  const auto near_one = [&] { return 1 + random.magnitude(-22, -3); };
  this->expect_within(this->bound(0.51), log, logl, wide);
  this->expect_within(this->bound(0.51), log, logl, near_one);
  this->expect_within(this->bound(0.51), log2, log2l, wide);
  this->expect_within(this->bound(0.51), log2, log2l, near_one);
}

TYPED_TEST(Elementary, PowersStayWithinTheirBound) {
  using R = TypeParam;
  Random random(3);
  double worst = 0;
  for (int i = 0; i < 300000; ++i) {
    // y log2(x) spreads over the whole exponent range, subnormal results included.
    const R x =
        static_cast<R>(i % 2 == 0 ? 1 + random.magnitude(-18, -2) : std::fabs(random.magnitude(-40, 40)));
    const double reach = random.uniform(-1.05, 1.02) * (this->is_double ? 1024 : 128);
    const R y = static_cast<R>(x == 1 ? 0 : reach / std::log2(static_cast<double>(x)));
    worst = std::max(worst, ulps<R>(kernels::pow(x, y), powl(x, y)));
  }
  EXPECT_LE(worst, this->bound(0.95));
}

TYPED_TEST(Elementary, TrigonometryStaysWithinItsBound) {
  using R = TypeParam;
  Random random(4);
  const auto sin = [](R x) { return kernels::sin(x); };
  const auto cos = [](R x) { return kernels::cos(x); };
  const auto tan = [](R x) { return kernels::tan(x); };
  for (const double range : {4.0, 1e6}) {
    const auto angle = [&] { return random.uniform(-range, range); };
    this->expect_within(this->bound(0.80), sin, sinl, angle);
    this->expect_within(this->bound(0.80), cos, cosl, angle);
    this->expect_within(this->bound(1.01), tan, tanl, angle);
  }
  this->expect_within(this->bound(0.80), sin, sinl, [&] { return random.magnitude(-100, 0); });
}

TYPED_TEST(Elementary, InverseTrigonometryStaysWithinItsBound) {
  using R = TypeParam;
  Random random(5);
  const auto atan = [](R x) { return kernels::atan(x); };
  const auto asin = [](R x) { return kernels::asin(x); };
  const auto acos = [](R x) { return kernels::acos(x); };
  this->expect_within(this->bound(0.70), atan, atanl, [&] { return random.magnitude(-60, 60); });
  this->expect_within(this->bound(0.70), asin, asinl, [&] { return random.uniform(-1, 1); });
  this->expect_within(this->bound(0.70), acos, acosl, [&] { return random.uniform(-1, 1); });
  this->expect_within(this->bound(0.70), acos, acosl,
                      [&] { return 1 - std::fabs(random.magnitude(-50, 0)); });
  double worst = 0;
  const double range = this->is_double ? 900 : 120;
  for (int i = 0; i < 200000; ++i) {
    const double reach = i % 2 == 0 ? 2 : range;
    const R y = static_cast<R>(random.magnitude(-reach, reach)),
            x = static_cast<R>(random.magnitude(-reach, reach));
    const double error = ulps<R>(kernels::atan2(y, x), atan2l(y, x));
    if (std::fabs(kernels::atan2(y, x)) < std::numeric_limits<R>::min())
      EXPECT_LE(error, 1) << y << ", " << x;
    else
      worst = std::max(worst, error);
  }
  EXPECT_LE(worst, this->bound(0.70));
}

TYPED_TEST(Elementary, QuarterTurnsInDegreesAreExact) {
  using R = TypeParam;
  const R far = static_cast<R>(360) * (1 << 13);
  for (const R turn : {R(0), R(360), R(-360), far}) {
    EXPECT_EQ(kernels::sin_cos_degrees(turn).sin, 0);
    EXPECT_EQ(kernels::sin_cos_degrees(turn).cos, 1);
    EXPECT_EQ(kernels::sin_cos_degrees(turn + 90).sin, 1);
    EXPECT_EQ(kernels::sin_cos_degrees(turn + 90).cos, 0);
    EXPECT_EQ(kernels::sin_cos_degrees(turn + 180).cos, -1);
    EXPECT_EQ(kernels::sin_cos_degrees(turn + 270).sin, -1);
    EXPECT_FALSE(std::signbit(kernels::sin_cos_degrees(turn + 180).sin));
  }
  EXPECT_EQ(kernels::sin_cos_degrees(R(30)).sin, R(0.5));
  EXPECT_EQ(kernels::sin_cos_degrees(R(60)).cos, R(0.5));
  EXPECT_EQ(kernels::tan_degrees(R(45)), R(1));
  EXPECT_EQ(kernels::tan_degrees(R(90)), std::numeric_limits<R>::infinity());
}

TEST(ElementaryDegrees, AgreeWithRadiansOfTheExactAngle) {
  Random random(6);
  constexpr long double degree = 3.14159265358979323846264338327950288L / 180;
  for (int i = 0; i < 100000; ++i) {
    const double d = random.uniform(-45, 45);  // beyond, the oracle's own product loses what it would judge
    EXPECT_LE(ulps(kernels::sin_cos_degrees(d).sin, sinl(d * degree)), 0.81) << d;
    EXPECT_LE(ulps(kernels::sin_cos_degrees(d).cos, cosl(d * degree)), 0.81) << d;
    EXPECT_EQ(kernels::sin_cos_degrees(d + 360).sin, kernels::sin_cos_degrees((d + 360) - 360).sin);
  }
}

// Values by mpmath with 3000 bits; the third argument is the double nearest to a multiple of pi/2.
TEST(ElementaryTrigonometry, ReducesHugeAnglesExactly) {
  const double nearest_multiple = 0x1.6ac5b262ca1ffp+849;
  EXPECT_LE(ulps(kernels::sin(1e22), -0.8522008497671888L), 1);
  EXPECT_LE(ulps(kernels::cos(1e22), 0.52321478539513895L), 1);
  EXPECT_LE(ulps(kernels::cos(nearest_multiple), -4.6871659242546276e-19L), 1);
  EXPECT_EQ(kernels::sin(nearest_multiple), 1);
  EXPECT_LE(ulps(kernels::sin(1e300), -0.8178819121159086L), 1);
  EXPECT_LE(ulps(kernels::cos(std::numeric_limits<double>::max()), -0.99998768942655994L), 1);
  EXPECT_LE(ulps(kernels::sin(-0x1p20), -0.33049314002173467L), 1);
  Random random(7);
  for (int i = 0; i < 20000; ++i) {
    const double x = random.magnitude(19, 62);  // x87's own reduction is exact below 2^63
    EXPECT_LE(ulps(kernels::sin(x), sinl(x)), 0.81) << std::hexfloat << x;
    EXPECT_LE(ulps(kernels::cos(x), cosl(x)), 0.81) << std::hexfloat << x;
  }
}

TEST(ElementarySpecialValues, FollowAnnexF) {
  EXPECT_EQ(kernels::exp(0.0), 1);
  EXPECT_EQ(kernels::exp(-inf), 0);
  EXPECT_EQ(kernels::exp(inf), inf);
  EXPECT_EQ(kernels::exp(1e300), inf);
  EXPECT_EQ(kernels::exp2(-1e300), 0);
  EXPECT_EQ(kernels::log(0.0), -inf);
  EXPECT_EQ(kernels::log2(-0.0F), -std::numeric_limits<float>::infinity());
  EXPECT_EQ(kernels::log(1.0), 0);
  EXPECT_EQ(kernels::log(inf), inf);
  for (int n = -1074; n < 1024; ++n) {
    EXPECT_EQ(kernels::exp2(static_cast<double>(n)), std::ldexp(1.0, n));
    EXPECT_EQ(kernels::log2(std::ldexp(1.0, n)), n);
  }
  for (const double bad :
       {kernels::log(-1.0), kernels::exp(nan), kernels::sin(inf), kernels::tan(-inf),
        kernels::acos(1.0000001), kernels::asin(nan), kernels::pow(-2.0, 0.5), kernels::atan2(nan, 1.0)})
    EXPECT_EQ(std::bit_cast<std::uint64_t>(bad), std::bit_cast<std::uint64_t>(nan));
  for (const double odd : {kernels::sin(-0.0), kernels::tan(-0.0), kernels::asin(-0.0), kernels::atan(-0.0),
                           kernels::sin_cos_degrees(-0.0).sin})
    EXPECT_TRUE(odd == 0 && std::signbit(odd));
}

template <class R>
void expect_special(R got, R want, double x, double y) {
  if (std::isnan(want)) {
    EXPECT_TRUE(std::isnan(got)) << x << ", " << y;
  } else {
    EXPECT_LE(ulps(got, want), 1.5) << x << ", " << y;
    EXPECT_EQ(std::signbit(got), std::signbit(want)) << x << ", " << y;
  }
}

// glibc's pow and atan2 give the right special values on every processor.
TEST(ElementarySpecialValues, OfTwoArgumentsAreThoseOfAnnexF) {
  const double values[] = {0.0, -0.0, 1,   -1,   2,   -2,     0.5,     -0.5,   3,
                           -3,  1.5,  inf, -inf, nan, 0x1p53, -0x1p54, 1e-320, 1e300};
  for (const double x : values)
    for (const double y : values) {
      expect_special(kernels::pow(x, y), std::pow(x, y), x, y);
      const float fx = static_cast<float>(x), fy = static_cast<float>(y);
      expect_special(kernels::pow(fx, fy), std::pow(fx, fy), x, y);
      expect_special(kernels::atan2(y, x), std::atan2(y, x), x, y);
    }
}

// Whatever processor runs this must find these bits.
TEST(ElementaryBits, AreThoseRecorded) {
  Random random(8);
  std::uint64_t mix = 0;
  const auto add = [&mix](double v) {
    mix = std::rotl(mix, 7) * 0x9e3779b97f4a7c15 + std::bit_cast<std::uint64_t>(v);
  };
  for (int i = 0; i < 10000; ++i) {
    const double x = random.uniform(-8, 8), y = random.uniform(-8, 8);  // without libm
    for (const double v : {kernels::exp(x), kernels::exp2(x), kernels::log(x * x), kernels::pow(x * x, y),
                           kernels::sin(x), kernels::cos(x), kernels::tan(x), kernels::atan2(x, y)})
      add(v);
    add(static_cast<double>(kernels::pow(static_cast<float>(x * x), static_cast<float>(y))));
  }
  EXPECT_EQ(mix, 5941808045548998175U);
}

}  // namespace
}  // namespace frustum
