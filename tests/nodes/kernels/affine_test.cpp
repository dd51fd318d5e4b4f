#include "nodes/kernels/affine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using kernels::Affine;
using kernels::EulerOrder;
using test::Random;
using test::ulps;

constexpr double u = 0x1p-53;

glm::dvec3 apply(const Affine& a, const glm::dvec3& p) { return a.linear * p + a.translation; }

// Largest entry of a b - I, the product in 80 bits.
double distance_from_identity(const glm::dmat3& a, const glm::dmat3& b) {
  using Long = glm::mat<3, 3, long double>;
  const Long m = Long(a) * Long(b);
  long double worst = 0;
  for (glm::length_t c = 0; c < 3; ++c)
    for (glm::length_t r = 0; r < 3; ++r) worst = std::max(worst, std::fabs(m[c][r] - (r == c ? 1 : 0)));
  return static_cast<double>(worst);
}

// Columns.
glm::dmat3 columns(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) { return {x, y, z}; }

// XFM-09.
TEST(Rotation, HasExactQuarterTurns) {
  const auto z = [](double degrees) { return kernels::rotation({0, 0, 2}, degrees)->linear; };
  EXPECT_EQ(z(0), glm::dmat3(1.0));
  EXPECT_EQ(z(90), columns({0, 1, 0}, {-1, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(z(180), columns({-1, 0, 0}, {0, -1, 0}, {0, 0, 1}));
  EXPECT_EQ(z(-90), z(270));
  EXPECT_EQ(z(360), glm::dmat3(1.0));
  EXPECT_EQ(kernels::rotation({1, 0, 0}, 90)->linear, columns({1, 0, 0}, {0, 0, 1}, {0, -1, 0}));
  EXPECT_EQ(kernels::rotation({0, -1, 0}, 90)->linear, columns({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}));
  EXPECT_NE(glm::rotate(glm::mat4(1.0F), glm::radians(90.0F), {0, 0, 1})[0][0], 0);  // the plain form leaks
  Affine four;
  for (int i = 0; i < 100000; ++i) four = kernels::composed(*kernels::rotation({0, 1, 0}, 90), four);
  EXPECT_EQ(four.linear, glm::dmat3(1.0));
}

TEST(Rotation, IsOrthonormalWithDeterminantOne) {
  Random random(1);
  for (int i = 0; i < 10000; ++i) {
    const glm::dvec3 axis(random.magnitude(-8, 8), random.magnitude(-8, 8), random.magnitude(-8, 8));
    const auto r = *kernels::rotation(axis, random.uniform(-720, 720));
    EXPECT_LE(distance_from_identity(r.linear, r.inverse_linear), 8 * u);
    EXPECT_FALSE(kernels::mirrors(r));
    EXPECT_LE(kernels::norm(r.linear * axis - axis), 12 * u * kernels::norm(axis));
  }
  EXPECT_FALSE(kernels::rotation({0, 0, 0}, 30).has_value());
  EXPECT_FALSE(kernels::rotation({0, std::nan(""), 0}, 30).has_value());
}

// XFM-07: (1 - cos t) of a small angle is 0 in the plain form.
TEST(Rotation, KeepsTheDigitsOfSmallAngles) {
  constexpr long double degree = 3.14159265358979323846264338327950288L / 180;
  const long double third = 1.0L / 3, root = sqrtl(third);
  for (int k = 0; k < 40; ++k) {
    const double degrees = std::pow(10.0, -k) * 40;
    const auto m = kernels::rotation({1, 1, 1}, degrees)->linear;
    const long double t = degrees * degree, versine = 2 * sinl(t / 2) * sinl(t / 2);
    EXPECT_LE(ulps(m[0][0], 1 - versine * (1 - third)), 4) << k;
    EXPECT_LE(ulps(m[0][1], versine * third + sinl(t) * root), 4) << k;
    EXPECT_LE(ulps(m[1][0], versine * third - sinl(t) * root), 4) << k;
  }
}

TEST(Euler, TurnsInItsOrderAboutFixedAxes) {
  // x first: y goes to z, then the turn about y takes z to x.
  const auto m = kernels::euler_rotation({90, 90, 0}, EulerOrder::xyz)->linear;
  EXPECT_EQ(m * glm::dvec3(0, 1, 0), glm::dvec3(1, 0, 0));
  // y first leaves y alone, then x takes it to z.
  EXPECT_EQ(kernels::euler_rotation({90, 90, 0}, EulerOrder::yxz)->linear * glm::dvec3(0, 1, 0),
            glm::dvec3(0, 0, 1));
  for (const auto order : {EulerOrder::xyz, EulerOrder::xzy, EulerOrder::yxz, EulerOrder::yzx,
                           EulerOrder::zxy, EulerOrder::zyx}) {
    const auto r = *kernels::euler_rotation({10, 20, 30}, order);
    EXPECT_LE(distance_from_identity(r.linear, r.inverse_linear), 24 * u);
  }
}

// XFM row 13 of the checklist: at 90 degrees only the difference of the outer angles is left.
TEST(Euler, ReportsGimbalLock) {
  EXPECT_EQ(kernels::gimbal_freedom({10, 90, 30}, EulerOrder::xyz), 0);
  EXPECT_EQ(kernels::gimbal_freedom({10, -90, 30}, EulerOrder::zyx), 0);
  EXPECT_EQ(kernels::gimbal_freedom({10, 90, 0}, EulerOrder::yxz), kernels::sin_cos_degrees(10.0).cos);
  EXPECT_NEAR(kernels::gimbal_freedom({0, 90 + 1e-9, 0}, EulerOrder::xyz), 1.7453292519943e-11, 1e-16);
  const auto a = kernels::euler_rotation({10, 90, 30}, EulerOrder::xyz)->linear;
  const auto b = kernels::euler_rotation({15, 90, 35}, EulerOrder::xyz)->linear;
  EXPECT_LE(kernels::norm(a[0] - b[0]) + kernels::norm(a[1] - b[1]) + kernels::norm(a[2] - b[2]), 16 * u);
}

TEST(Quaternion, AgreesWithAxisAndAngle) {
  const double h = std::sqrt(0.5);
  EXPECT_EQ(kernels::quaternion_rotation(h, {h, 0, 0})->linear, kernels::rotation({1, 0, 0}, 90)->linear);
  EXPECT_EQ(kernels::quaternion_rotation(0, {0, 0, 1e-200})->linear,
            kernels::rotation({0, 0, 1}, 180)->linear);
  EXPECT_FALSE(kernels::quaternion_rotation(0, {0, 0, 0}).has_value());
  Random random(2);
  for (int i = 0; i < 10000; ++i) {
    const auto axis = *kernels::normalized(
        glm::dvec3(random.magnitude(-4, 0), random.magnitude(-4, 0), random.magnitude(-4, 0)));
    const double degrees = random.uniform(-180, 180);
    const auto [s, c] = kernels::sin_cos_degrees(degrees / 2);
    const auto q = kernels::quaternion_rotation(3 * c, axis * (3 * s))->linear;
    const auto r = kernels::rotation(axis, degrees)->linear;
    for (glm::length_t k = 0; k < 3; ++k) EXPECT_LE(kernels::largest_component(q[k] - r[k]), 12 * u);
  }
}

// XFM-02: GLM's inverse returns (4, -1, 2) for this point in float.
TEST(Composition, KeepsTheInverseOfALargeTranslation) {
  const auto rotate = *kernels::rotation({1, 2, 3}, 0.7 * 180 / 3.141592653589793);
  const auto move = kernels::translation({1e7, 2e7, -3e7});
  const glm::dvec3 p(0.25, 0.5, 0.75);
  for (const auto& m : {kernels::composed(move, rotate), kernels::composed(rotate, move)})
    EXPECT_LE(kernels::norm(apply(kernels::inverse(m), apply(m, p)) - p), 8 * u * 4e7);
  EXPECT_EQ(apply(kernels::composed(move, rotate), p), apply(move, apply(rotate, p)));
}

// XFM-03.
TEST(Scaling, InvertsExtremeFactors) {
  const auto tiny = *kernels::scaling(glm::dvec3(1e-20));
  EXPECT_EQ(tiny.inverse_linear[0][0], 1e20);
  EXPECT_EQ(kernels::rcond(tiny), 1);
  EXPECT_FALSE(kernels::scaling({1, 0, 1}).has_value());
  EXPECT_FALSE(kernels::scaling({1, std::numeric_limits<double>::infinity(), 1}).has_value());
  EXPECT_FALSE(std::isfinite(glm::inverse(glm::mat4(1e-20F))[0][0]));  // the plain form
  EXPECT_TRUE(kernels::mirrors(*kernels::scaling({-1, 1, 1})));
  EXPECT_FALSE(kernels::mirrors(*kernels::scaling({-1e-30, -1e-30, 1e-30})));
}

// XFM-04: the condition is 1e16, yet the structured inverse of the shear is exact.
TEST(Shearing, InvertsByItsSign) {
  for (const auto& [moved, by] : {std::pair{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}}) {
    const auto shear = kernels::shearing(moved, by, 1e8);
    EXPECT_EQ(shear.linear * shear.inverse_linear, glm::dmat3(1.0));
    glm::dvec3 p(2, 3, 5), moved_p = p;
    moved_p[moved] += 1e8 * p[by];
    EXPECT_EQ(apply(shear, p), moved_p);
  }
  const auto turn = *kernels::rotation({1, 1, 0}, 57);
  const auto all = kernels::composed(kernels::shearing(0, 1, 1e8), turn);
  EXPECT_LE(distance_from_identity(all.linear, all.inverse_linear), 16 * u * 1e16);
}

// XFM-10: normals stay perpendicular to transformed edges under 1e16 : 1 scales; the inverse transpose of the
// product by cofactors in float overflows.
TEST(NormalMatrix, KeepsNormalsPerpendicular) {
  Random random(3);
  for (const glm::dvec3 s : {glm::dvec3(1e8, 1, 1e-8), glm::dvec3(1e-13), glm::dvec3(-1, 1, 1)}) {
    const auto m = kernels::composed(*kernels::scaling(s), kernels::shearing(0, 2, 0.5));
    for (int i = 0; i < 1000; ++i) {
      const glm::dvec3 e(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const glm::dvec3 f(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      const auto n = *kernels::normalized(kernels::normal_matrix(m) * kernels::cross(e, f));
      for (const auto& edge : {e, f}) {
        const glm::dvec3 moved = m.linear * edge;
        // 16 u: the cross product, two matrix products of three terms, each relative to the sum of sizes.
        double size = 0;
        for (glm::length_t k = 0; k < 3; ++k) size += std::fabs(n[k] * moved[k]);
        EXPECT_LE(std::fabs(kernels::dot(n, moved)), 16 * u * (size + kernels::norm(moved)));
      }
    }
  }
}

TEST(AffineFromMatrix, RefusesWhatIsNotInvertibleAndAffine) {
  glm::dmat4 m(1.0);
  EXPECT_TRUE(kernels::affine_from_matrix(m).has_value());
  m[1] = m[0];
  EXPECT_FALSE(kernels::affine_from_matrix(m).has_value());
  glm::dmat4 projective(1.0);
  projective[2][3] = -1;
  EXPECT_FALSE(kernels::affine_from_matrix(projective).has_value());
  glm::dmat4 undefined(1.0);
  undefined[3][0] = std::nan("");
  EXPECT_FALSE(kernels::affine_from_matrix(undefined).has_value());
  glm::dmat4 tiny(1e-20);
  tiny[3][3] = 1;
  EXPECT_EQ(kernels::affine_from_matrix(tiny)->inverse_linear[2][2], 1e20);
}

TEST(PointMap, IsTheMapInTheBuffersPrecision) {
  const auto a = kernels::composed(kernels::translation({1, 2, 3}), *kernels::rotation({0, 0, 1}, 90));
  EXPECT_EQ(kernels::PointMap<float>(a)({1, 0, 0}), glm::vec3(1, 3, 3));
  EXPECT_EQ(kernels::PointMap<double>(a)({0, 1, 0}), glm::dvec3(0, 2, 3));
}

}  // namespace
}  // namespace frustum
