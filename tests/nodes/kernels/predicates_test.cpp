#include "nodes/kernels/predicates.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

__extension__ using int128 = __int128;
int sign(int128 x) { return x > 0 ? 1 : (x < 0 ? -1 : 0); }

// FND-07: Kettner et al. 2008, "Classroom examples of robustness problems".
TEST(Orientation, IsExactOnTheClassroomGrid) {
  const glm::dvec2 q(12, 12), r(24, 24);
  int naive_wrong = 0;
  for (int i = 0; i < 256; ++i)
    for (int j = 0; j < 256; ++j) {
      const glm::dvec2 p(0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53);
      // In units of 2^-53 every coordinate is an integer below 2^58.
      const auto px = static_cast<int128>(p.x * 0x1p53), py = static_cast<int128>(p.y * 0x1p53);
      const int128 twelve = int128{12} << 53;
      const int exact = sign((twelve - px) * (2 * twelve - py) - (2 * twelve - px) * (twelve - py));
      ASSERT_EQ(kernels::orientation(p, q, r), exact);
      ASSERT_EQ(kernels::orientation(q, r, p), exact);
      ASSERT_EQ(kernels::orientation(q, p, r), -exact);
      const double naive = (q.x - p.x) * (r.y - p.y) - (r.x - p.x) * (q.y - p.y);
      if (sign(naive > 0 ? 1 : (naive < 0 ? -1 : 0)) != exact) ++naive_wrong;
    }
  EXPECT_GT(naive_wrong, 10000);
}

// XFM-16: rows of 40-bit integers, the third nearly a combination of the others.
TEST(DeterminantSign, IsExactForNearlyDependentRows) {
  test::Random random(1);
  int zeros = 0, naive_wrong = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto component = [&random] {
      return static_cast<std::int64_t>(random.below(1U << 20)) - (1 << 19);
    };
    std::int64_t a[3], b[3], c[3];
    const std::int64_t s = component(), t = component();
    for (int k = 0; k < 3; ++k) {
      a[k] = component(), b[k] = component();
      c[k] = s * a[k] + t * b[k] + (k == i % 3 && i % 4 != 0 ? 1 : 0);
    }
    const auto minor = [&](int j, int k) { return int128{b[j]} * c[k] - int128{b[k]} * c[j]; };
    const int exact = sign(a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1));
    const auto row = [](const std::int64_t* v) { return glm::dvec3(v[0], v[1], v[2]) * 0x1p-30; };
    const glm::dvec3 p = row(a), q = row(b), r = row(c);
    EXPECT_EQ(kernels::determinant_sign(p, q, r), exact);
    EXPECT_EQ(kernels::determinant_sign(q, p, r), -exact);
    EXPECT_EQ(kernels::determinant_sign(q, r, p), exact);
    zeros += exact == 0 ? 1 : 0;
    const double naive =
        kernels::dot(p, glm::dvec3(q.y * r.z - q.z * r.y, q.z * r.x - q.x * r.z, q.x * r.y - q.y * r.x));
    naive_wrong += sign(naive > 0 ? 1 : (naive < 0 ? -1 : 0)) != exact ? 1 : 0;
  }
  EXPECT_GT(zeros, 20000);
  EXPECT_GT(naive_wrong, 10000);
}

TEST(DeterminantSign, SurvivesExtremeScalesAndRefusesNonsense) {
  const auto s = [](double x, double y, double z) {
    return kernels::determinant_sign(glm::dvec3(x, 0, 0), glm::dvec3(0, y, 0), glm::dvec3(0, 0, z));
  };
  EXPECT_EQ(s(1e-300, 1e-300, 1e-300), 1);
  EXPECT_EQ(s(1e300, -1e300, 1e300), -1);
  EXPECT_EQ(s(0, 1, 1), 0);
  EXPECT_EQ(s(std::numeric_limits<double>::quiet_NaN(), 1, 1), 0);
  EXPECT_EQ(s(std::numeric_limits<double>::infinity(), 1, 1), 0);
  EXPECT_EQ(kernels::determinant_sign(glm::vec3(1, 2, 3), glm::vec3(4, 5, 6), glm::vec3(7, 8, 10)), -1);
}

// FND-08 holds it to rationals; here, what the sign means, and points that differ in their last bits.
TEST(Orientation, TellsTheSidesOfAPlane) {
  const glm::dvec3 p(0, 0, 0), q(1, 0, 0), r(0, 1, 0);  // counter-clockwise seen from +z
  EXPECT_EQ(kernels::orientation(p, q, r, glm::dvec3(5, 5, 1)), -1);
  EXPECT_EQ(kernels::orientation(p, q, r, glm::dvec3(5, 5, -1)), 1);
  EXPECT_EQ(kernels::orientation(p, q, r, glm::dvec3(5, 5, 0)), 0);
  const glm::dvec3 far(1e7, 1e7, 1e7), up(0, 0, 0x1p-29);  // the last bit of 1e7
  EXPECT_EQ(kernels::orientation(p + far, q + far, r + far, far + glm::dvec3(1, 1, 0) + up), -1);
  EXPECT_EQ(kernels::orientation(p + far, q + far, r + far, far + glm::dvec3(1, 1, 0)), 0);
  EXPECT_EQ(kernels::orientation(p, q, r, glm::dvec3(0, 0, std::numeric_limits<double>::quiet_NaN())), 0);
}

}  // namespace
}  // namespace frustum
