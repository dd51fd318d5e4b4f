#include "nodes/kernels/vector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using test::Random;
using test::ulps;

template <class R>
glm::vec<3, R> random_vector(Random& random, double lowest, double highest) {
  return {static_cast<R>(random.magnitude(lowest, highest)),
          static_cast<R>(random.magnitude(lowest, highest)),
          static_cast<R>(random.magnitude(lowest, highest))};
}

template <class V>
long double norm_oracle(const V& v) {
  long double sum = 0;
  for (glm::length_t i = 0; i < V::length(); ++i) sum += static_cast<long double>(v[i]) * v[i];
  return sqrtl(sum);
}

template <class R>
double worst_component(const glm::vec<3, R>& unit, const glm::vec<3, R>& v) {
  const long double length = norm_oracle(v);
  double worst = 0;
  for (glm::length_t i = 0; i < 3; ++i) worst = std::max(worst, ulps(unit[i], v[i] / length));
  return worst;
}

template <class R>
class VectorKernels : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(VectorKernels, Reals);

// FND-01, FND-02, and with them the whole range of each type.
TYPED_TEST(VectorKernels, NormalizesEveryMagnitude) {
  using R = TypeParam;
  using limits = std::numeric_limits<R>;
  Random random(1);
  const double bound = sizeof(R) == 4 ? 1 : 2;
  int naive_failures = 0;
  for (int k = limits::min_exponent - limits::digits + 26; k < limits::max_exponent - 2; ++k) {
    const auto v = random_vector<R>(random, k - 1, k);
    const auto unit = kernels::normalized(v);
    ASSERT_TRUE(unit.has_value()) << k;
    EXPECT_LE(worst_component(*unit, v), bound) << "2^" << k;
    EXPECT_LE(std::fabs(norm_oracle(*unit) - 1), 2 * limits::epsilon() / 2) << "2^" << k;
    if (!(worst_component(glm::normalize(v), v) <= bound)) ++naive_failures;
  }
  EXPECT_GT(naive_failures, 50);  // the plain form fails where this test looks
}

TEST(VectorNormalize, SolvesTheRecordedCases) {
  EXPECT_LE(worst_component(*kernels::normalized(glm::vec3(1e20F)), glm::vec3(1e20F)), 1);
  EXPECT_LE(worst_component(*kernels::normalized(glm::vec3(1e-23F, 1e-23F, 0)), glm::vec3(1e-23F, 1e-23F, 0)),
            1);
  const glm::vec3 five(3e-22F, 4e-22F, 0);
  EXPECT_LE(worst_component(*kernels::normalized(five), five), 1);
  EXPECT_EQ(*kernels::normalized(glm::dvec3(0, 0x1p-1074, 0)), glm::dvec3(0, 1, 0));
  EXPECT_EQ(*kernels::normalized(glm::vec2(-std::numeric_limits<float>::max(), 0)), glm::vec2(-1, 0));
}

// FND-03.
TEST(VectorNormalize, ReportsVectorsWithoutADirection) {
  constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const glm::vec3 v : {glm::vec3(0), glm::vec3(-0.0F, 0, 0), glm::vec3(inf, 1, 0), glm::vec3(nan, 0, 0),
                            glm::vec3(1, nan, inf), glm::vec3(0, 0, -inf)}) {
    EXPECT_FALSE(kernels::normalized(v).has_value());
    EXPECT_EQ(kernels::normalized_or(v, {0, 0, 1}), glm::vec3(0, 0, 1));
  }
}

TYPED_TEST(VectorKernels, NormStaysWithinItsBoundAndRange) {
  using R = TypeParam;
  using limits = std::numeric_limits<R>;
  Random random(2);
  for (int i = 0; i < 100000; ++i) {
    const auto v = random_vector<R>(random, limits::min_exponent - 10, limits::max_exponent - 2);
    EXPECT_LE(ulps(kernels::norm(v), norm_oracle(v)), 1.5);
  }
  EXPECT_EQ(kernels::norm(glm::vec<3, R>(0)), 0);
  EXPECT_EQ(kernels::norm(glm::vec<3, R>(1, -limits::infinity(), 0)), limits::infinity());
  EXPECT_TRUE(std::isnan(kernels::norm(glm::vec<3, R>(limits::infinity(), limits::quiet_NaN(), 0))));
  EXPECT_EQ(kernels::norm(glm::vec<2, R>(limits::max(), limits::max())), limits::infinity());
}

TYPED_TEST(VectorKernels, DifferenceOfProductsKeepsItsDigitsUnderCancellation) {
  using R = TypeParam;
  Random random(3);
  double worst = 0, naive = 0;
  for (int i = 0; i < 100000; ++i) {
    const R a = static_cast<R>(random.uniform(1, 2)), b = static_cast<R>(random.uniform(1, 2));
    const R c = a * (1 + std::numeric_limits<R>::epsilon() * static_cast<R>(random.below(8)));
    const R d = b * (1 - std::numeric_limits<R>::epsilon() * static_cast<R>(random.below(8)));
    // The products have 2 p digits: __float128 holds both, and their difference, exactly.
    __extension__ using quad = __float128;
    const auto exact = static_cast<long double>(static_cast<quad>(a) * b - static_cast<quad>(c) * d);
    worst = std::max(worst, ulps(kernels::difference_of_products(a, b, c, d), exact));
    const R plain = a * b - c * d;
    naive = std::max(naive, exact == 0 ? 0 : ulps(plain, exact));
  }
  EXPECT_LE(worst, 1.5);
  EXPECT_GT(naive, 1e3);
}

// FND-04: acos of the dot product returns 0 for all but the first few of these.
TYPED_TEST(VectorKernels, AngleKeepsItsDigitsNearZeroAndPi) {
  using R = TypeParam;
  using V = glm::vec<3, R>;
  int naive_failures = 0;
  for (int k = 1; k <= 30; ++k) {
    const long double t = powl(10, -k);
    const V b(static_cast<R>(cosl(t)), static_cast<R>(sinl(t)), 0);
    const long double exact = atan2l(b.y, b.x);  // of the vector as stored
    EXPECT_LE(ulps(kernels::angle_between(V(1, 0, 0), b), exact), 4) << k;
    EXPECT_LE(ulps(kernels::angle_between(V(0, 0, 5), V(0, b.y * 3, b.x * 3)), atan2l(b.y * 3, b.x * 3)), 4)
        << k;
    EXPECT_LE(ulps(kernels::angle_between(V(-1, 0, 0), b), atan2l(b.y, -b.x)), 4) << k;
    if (!(ulps(static_cast<R>(std::acos(std::min(R(1), b.x))), exact) <= 4)) ++naive_failures;
  }
  EXPECT_GT(naive_failures, 20);
  EXPECT_EQ(kernels::angle_between(V(0), V(1, 0, 0)), 0);
  EXPECT_LE(ulps(kernels::angle_between(V(R(1e30), 0, 0), V(0, R(1e-30), 0)), 1.57079632679489661923L), 1);
}

TYPED_TEST(VectorKernels, CrossOfParallelVectorsIsZero) {
  using R = TypeParam;
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const auto v = random_vector<R>(random, -3, 3);
    EXPECT_EQ(kernels::cross(v, v), (glm::vec<3, R>(0)));
    EXPECT_EQ(kernels::cross(v, v * R(-4)), (glm::vec<3, R>(0)));
  }
  EXPECT_EQ(kernels::cross(glm::vec<3, R>(1, 0, 0), glm::vec<3, R>(0, 1, 0)), (glm::vec<3, R>(0, 0, 1)));
}

TEST(VectorReflect, IsAnInvolutionThatKeepsTheNormalPart) {
  EXPECT_EQ(kernels::reflected(glm::dvec3(1, 1, 0), glm::dvec3(0, 1, 0)), glm::dvec3(-1, 1, 0));
  Random random(5);
  for (int i = 0; i < 10000; ++i) {
    const auto n = *kernels::normalized(random_vector<double>(random, -4, 0));
    const auto l = random_vector<double>(random, -2, 2);
    const auto r = kernels::reflected(l, n);
    const double size = kernels::norm(l);
    // 12 u: three products and sums a component, and |n| off 1 by up to 2 u, doubled by the factor 2.
    EXPECT_LE(kernels::norm(kernels::reflected(r, n) - l), 24 * 0x1p-53 * size);
    EXPECT_NEAR(kernels::norm(r), size, 12 * 0x1p-53 * size);
    EXPECT_NEAR(kernels::dot(r, n), kernels::dot(l, n), 12 * 0x1p-53 * size);
  }
}

// FND-12: a + t (b - a) misses b for one pair in six.
TEST(VectorLerp, IsExactAtBothEndsAndMonotonic) {
  Random random(6);
  int naive_misses = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto a = random_vector<float>(random, -20, 20), b = random_vector<float>(random, -20, 20);
    EXPECT_EQ(kernels::lerp(a, b, 0.0F), a);
    EXPECT_EQ(kernels::lerp(a, b, 1.0F), b);
    EXPECT_EQ(kernels::lerp(a, a, static_cast<float>(random.uniform())), a);
    if (a + (b - a) != b) ++naive_misses;
    const auto t = static_cast<float>(random.uniform(0, 0.999));
    const float next = std::nextafter(t, 2.0F);
    for (int c = 0; c < 3; ++c) {
      const float at = kernels::lerp(a, b, t)[c], after = kernels::lerp(a, b, next)[c];
      EXPECT_TRUE(a[c] <= b[c] ? at <= after : at >= after);
    }
  }
  EXPECT_GT(naive_misses, 2000);
}

// XFM-13: Frisvad's frame divides by 1 + n.z.
TYPED_TEST(VectorKernels, FrameIsOrthonormalEverywhere) {
  using R = TypeParam;
  using V = glm::vec<3, R>;
  Random random(7);
  const R u = std::numeric_limits<R>::epsilon() / 2;
  const auto check = [u](const V& n) {
    const auto [t, b] = kernels::orthonormal_frame(n);
    using L = glm::vec<3, long double>;
    EXPECT_LE(std::fabs(kernels::dot(L(t), L(b))), 6 * u);
    EXPECT_LE(std::fabs(kernels::dot(L(t), L(n))), 6 * u);
    EXPECT_LE(std::fabs(kernels::dot(L(b), L(n))), 6 * u);
    EXPECT_LE(std::fabs(norm_oracle(t) - 1), 6 * u);
    EXPECT_LE(std::fabs(norm_oracle(b) - 1), 6 * u);
    EXPECT_GT(kernels::dot(kernels::cross(t, b), n), R(0.99));
  };
  for (const R z : {R(1), R(-1)}) check({0, 0, z});
  check(*kernels::normalized(V(R(1e-4), R(1e-4), -1)));
  for (int i = 0; i < 100000; ++i) check(*kernels::normalized(random_vector<R>(random, -12, 0)));
}

}  // namespace
}  // namespace frustum
