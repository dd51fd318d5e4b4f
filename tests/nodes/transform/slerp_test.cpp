#include "nodes/transform/slerp.h"

#include "nodes/kernels/matrix.h"
#include "nodes/kernels/quaternion.h"
#include "nodes/transform.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

glm::dvec4 about_x(double degrees) {
  const auto [s, c] = kernels::sin_cos_degrees(degrees / 2);
  return {c, s, 0, 0};
}
Ref<Matrix> matrix(const kernels::Affine& a) {
  return std::make_shared<const Matrix>(Matrix{kernels::matrix_of(a)});
}

TEST(TransformSlerp, TurnsAtConstantSpeed) {
  for (const double t : {0.0, 0.1, 0.25, 0.5, 0.9, 1.0}) {
    const glm::dvec4 q = transform::slerp(about_x(10), about_x(130), t);
    EXPECT_LE(kernels::largest_component(q - about_x(10 + 120 * t)), 4 * 0x1p-53) << t;
  }
}

// Hard case XFM-08.
TEST(TransformSlerp, HoldsForRotationsThatAreNearlyEqualOrOpposite) {
  for (const double degrees : {0.0, 1e-300, 1e-12, 1e-6, 1e-3, 359.999999, 180.0}) {
    for (const double t : {0.0, 0.3, 1.0}) {
      const glm::dvec4 a = about_x(20), b = about_x(20 + degrees);
      const glm::dvec4 q = transform::slerp(a, b, t), back = transform::slerp(b, a, 1 - t);
      EXPECT_LE(std::fabs(kernels::norm(q) - 1), 2 * 0x1p-52);
      const double apart =
          std::min(kernels::largest_component(q - back), kernels::largest_component(q + back));
      if (degrees != 180) {
        EXPECT_LE(apart, 4 * 0x1p-52) << degrees << " " << t;
      }
    }
  }
  const double acos_of_dot = std::acos(kernels::dot(about_x(0), about_x(1e-6)));
  EXPECT_NEAR(transform::arc(about_x(0), about_x(1e-6)) / (0.5e-6 * 3.141592653589793 / 180), 1, 1e-14);
  EXPECT_EQ(acos_of_dot, 0) << "the plain angle has no digit left";
}

TEST(TransformSlerp, TakesTheShorterWayAndKeepsTheEnds) {
  const auto a = kernels::rotation({0, 0, 1}, 350).value(), b = kernels::rotation({0, 0, 1}, 20).value();
  const auto at = [&](double t) {
    return test::run_node(nodes::transform_slerp(), {{"t", t}}, {{matrix(a)}, {matrix(b)}});
  };
  const auto expected = kernels::matrix_of(kernels::rotation({0, 0, 1}, 5).value());
  const auto half = at(0.5);
  for (glm::length_t c = 0; c < 4; ++c)
    EXPECT_LE(kernels::largest_component(half.at(0).as<Matrix>()->value[c] - expected[c]), 1e-15);
  EXPECT_NEAR(half.at(1).as<Number>()->value, 30, 1e-12);
  for (glm::length_t c = 0; c < 3; ++c)
    EXPECT_LE(kernels::largest_component(glm::dvec3(at(1).at(0).as<Matrix>()->value[c]) - b.linear[c]),
              4 * 0x1p-53);
}

// Gimbal lock (row 13): half way between two rotations at a pitch of 90 degrees, the angles' mean turns elsewhere.
TEST(TransformSlerp, GoesThroughWhereEulerAnglesLock) {
  using kernels::EulerOrder;
  const auto a = kernels::euler_rotation({30, 90, 0}, EulerOrder::xyz).value();
  const auto b =
      kernels::euler_rotation({0, 90, 60}, EulerOrder::xyz).value();  // one turn about one axis apart
  const auto mean = kernels::euler_rotation({15, 90, 30}, EulerOrder::xyz).value();
  EXPECT_LT(kernels::gimbal_freedom({30, 90, 0}, EulerOrder::xyz), 1e-15);
  const glm::dvec4 qa = kernels::quaternion_of(a.linear), qb = kernels::quaternion_of(b.linear);
  const glm::dvec4 q = transform::slerp(qa, qb, 0.5);
  const double to_a = transform::arc(q, qa), to_b = std::min(transform::arc(q, qb), transform::arc(q, -qb));
  EXPECT_NEAR(to_a, to_b, 1e-15) << "half way is as far from both";
  const glm::dvec4 qm = kernels::quaternion_of(mean.linear);
  const double gap = std::min(transform::arc(q, qm), transform::arc(q, -qm));
  EXPECT_LT(gap, 1e-7) << "both turns are about one axis, where the means agree as well";
}

TEST(TransformSlerp, WarnsOfTwoEqualWaysAndRefusesWhatIsNoRotation) {
  const auto a = kernels::rotation({0, 0, 1}, 0).value(), b = kernels::rotation({0, 0, 1}, 180).value();
  Context ctx;
  static_cast<void>(test::run_node(nodes::transform_slerp(), {{"t", 0.5}}, {{matrix(a)}, {matrix(b)}}, &ctx));
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "opposite_rotations");
  const auto scaled = kernels::scaling({2, 2, 2}).value(), mirrored = kernels::scaling({1, 1, -1}).value();
  for (const auto& bad : {scaled, mirrored})
    EXPECT_EQ(test::run_error(nodes::transform_slerp(), Json::object(), {{matrix(a)}, {matrix(bad)}}).first,
              "no_rotation");
}

}  // namespace
}  // namespace frustum
