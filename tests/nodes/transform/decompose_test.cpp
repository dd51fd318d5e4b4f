#include "nodes/transform/decompose.h"

#include "nodes/kernels/affine.h"
#include "nodes/kernels/quaternion.h"
#include "nodes/transform.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <random>

namespace frustum {
namespace {

using transform::Parts;
using transform::Split;

glm::dmat3 random_linear(std::mt19937_64& random, int spread) {
  std::uniform_real_distribution<double> in(-1, 1);
  std::uniform_int_distribution<int> exponent(-spread, spread);
  glm::dmat3 m;
  for (glm::length_t c = 0; c < 3; ++c) {
    const double scale = std::ldexp(1.0, exponent(random));
    for (glm::length_t r = 0; r < 3; ++r) m[c][r] = in(random)*scale;
  }
  return m;
}
glm::dmat4 affine(const glm::dmat3& linear) {
  glm::dmat4 m(1.0);
  for (glm::length_t c = 0; c < 3; ++c) m[c] = glm::dvec4(linear[c], 0);
  m[3] = {5, -6, 7, 1};
  return m;
}
double off_orthonormal(const glm::dmat3& r) {
  return transform::largest_entry(glm::transpose(r) * r - glm::dmat3(1.0));
}

class Decompose : public testing::TestWithParam<Split> {};

TEST_P(Decompose, GivesRotationsOfDeterminantOneWhoseProductIsTheMap) {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 3000; ++trial) {
    glm::dmat3 m = random_linear(random, trial % 3 == 0 ? 20 : 2);
    if (trial % 5 == 0) m[2] = m[0] + m[1] * 0.5 + m[2] * 1e-9;  // nearly flat
    const auto p = transform::parts_of(affine(m), GetParam());
    // Rounding may have put the third column into the plane of the others.
    ASSERT_EQ(p.has_value(), kernels::determinant_sign(m[0], m[1], m[2]) != 0) << trial;
    if (!p) continue;
    EXPECT_LE(off_orthonormal(p->rotation), 8 * 0x1p-52) << trial;
    EXPECT_LE(off_orthonormal(p->turn), 8 * 0x1p-52) << trial;
    EXPECT_GT(kernels::determinant_sign(p->rotation[0], p->rotation[1], p->rotation[2]), 0);
    EXPECT_GT(kernels::determinant_sign(p->turn[0], p->turn[1], p->turn[2]), 0);
    EXPECT_LE(transform::largest_entry(p->linear() - m), 16 * 0x1p-53 * transform::largest_entry(m)) << trial;
    EXPECT_EQ(p->mirrors(), kernels::determinant_sign(m[0], m[1], m[2]) < 0) << trial;
    EXPECT_GT(p->scale.x, 0);
    EXPECT_GT(p->scale.y, 0);
    EXPECT_EQ(p->translation, glm::dvec3(5, -6, 7));
  }
}

INSTANTIATE_TEST_SUITE_P(BothWays, Decompose, testing::Values(Split::shear, Split::turns));

TEST(TransformDecompose, FindsThePartsItWasMadeOf) {
  const auto turn = kernels::rotation({1, 2, 3}, 40).value();
  Parts made;
  made.rotation = turn.linear;
  made.scale = {2, 3, -4};
  made.shear[1][0] = 0.5, made.shear[2][0] = -0.25, made.shear[2][1] = 1.5;
  const auto found = transform::parts_of(affine(made.linear()), Split::shear);
  EXPECT_LE(transform::largest_entry(found->rotation - made.rotation), 1e-14);
  EXPECT_LE(transform::largest_entry(found->shear - made.shear), 1e-14);
  EXPECT_LE(kernels::largest_component(found->scale - made.scale), 1e-14);
}

TEST(TransformDecompose, SplitsAShearIntoTwoTurns) {
  // Errata E6: a shear is a rotation, a scale and a rotation. Of x += y the factors are the golden ratio and its inverse.
  const auto p = transform::parts_of(affine(kernels::shearing(0, 1, 1).linear), Split::turns);
  EXPECT_NEAR(p->scale.x, 1.618033988749895, 1e-15);
  EXPECT_NEAR(p->scale.y, 1, 1e-15);
  EXPECT_NEAR(p->scale.z, 0.6180339887498949, 1e-15);
  EXPECT_EQ(p->shear, glm::dmat3(1.0));
}

// Hard case XFM-06: at half a turn the scalar part is 0, and (1 + trace) / 4 has no digit of it.
TEST(TransformDecompose, FindsTheQuaternionOfHalfATurn) {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        for (const double degrees : {180.0, 179.99, 179.9999999, 120.0, 1e-7}) {
          const auto r = kernels::rotation(glm::dvec3(x, y, z), degrees).value().linear;
          const glm::dvec4 q = kernels::quaternion_of(r);
          const auto [s, c] = kernels::sin_cos_degrees(degrees / 2);
          const glm::dvec3 n = *kernels::normalized(glm::dvec3(x, y, z));
          const glm::dvec4 expected(c, n * s);
          const double error =
              std::min(kernels::largest_component(q - expected), kernels::largest_component(q + expected));
          EXPECT_LE(error, 4 * 0x1p-52) << x << y << z << " " << degrees;
        }
      }
}

TEST(TransformDecompose, GivesFactorsAsMatricesAndRefusesWhatHasNoInverse) {
  const auto m = std::make_shared<const Matrix>(Matrix{affine({{0, 2, 0}, {-3, 0, 0}, {0, 0, -1}})});
  const auto out = test::run_node(nodes::transform_decompose(), Json::object(), {{m}});
  EXPECT_EQ(out.at(4).as<Matrix>()->value[2][2], -1) << "scale.z says that it mirrors";
  EXPECT_EQ(out.at(6).as<Number>()->value, 0);
  EXPECT_THAT(out.at(0).as<Table>()->columns[0].texts, testing::Contains("shear"));
  glm::dmat4 flat = affine({{1, 2, 3}, {2, 4, 6}, {0, 0, 1}});
  const auto code = [](const glm::dmat4& bad) {
    return test::run_error(nodes::transform_decompose(), Json::object(),
                           {{std::make_shared<const Matrix>(Matrix{bad})}})
        .first;
  };
  EXPECT_EQ(code(flat), "singular_transform");
  flat = glm::dmat4(1.0), flat[2][3] = -1;
  EXPECT_EQ(code(flat), "singular_transform") << "a perspective";
}

}  // namespace
}  // namespace frustum
