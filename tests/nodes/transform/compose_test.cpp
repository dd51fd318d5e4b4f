#include "nodes/transform/compose.h"

#include "nodes/transform.h"
#include "runtime/buffers/value.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace frustum {
namespace {

__extension__ using Quad = __float128;

Ref<Matrix> matrix(const glm::dmat4& m) { return std::make_shared<const Matrix>(Matrix{m}); }

TEST(TransformCompose, LetsTheFirstMapActFirst) {
  glm::dmat4 move(1.0), grow(1.0);
  move[3] = {1, 0, 0, 1};
  grow[0][0] = grow[1][1] = grow[2][2] = 2;
  const auto out = test::run_node(nodes::transform_compose(), Json::object(), {{matrix(move), matrix(grow)}});
  EXPECT_EQ(out.at(0).as<Matrix>()->value * glm::dvec4(3, 0, 0, 1), glm::dvec4(8, 0, 0, 1));
  const auto other =
      test::run_node(nodes::transform_compose(), Json::object(), {{matrix(grow), matrix(move)}});
  EXPECT_EQ(other.at(0).as<Matrix>()->value * glm::dvec4(3, 0, 0, 1), glm::dvec4(7, 0, 0, 1));
  EXPECT_EQ(test::run_node(nodes::transform_compose(), Json::object(), {{}}).at(0).as<Matrix>()->value,
            glm::dmat4(1.0));
}

TEST(TransformCompose, RoundsEveryEntryOnceWhereProductsCancel) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> in(-1, 1);
  double worst_plain = 0;
  for (int trial = 0; trial < 500; ++trial) {
    glm::dmat4 a, b;
    for (glm::length_t c = 0; c < 4; ++c)
      for (glm::length_t r = 0; r < 4; ++r) a[c][r] = in(random), b[c][r] = in(random);
    a[3] = -a[0] + a[1] * 1e-9;  // columns that nearly cancel with the rows b[.][0] = b[.][3]
    for (glm::length_t c = 0; c < 4; ++c) b[c][3] = b[c][0];
    const glm::dmat4 got = kernels::matrix_product(a, b), plain = a * b;
    for (glm::length_t c = 0; c < 4; ++c)
      for (glm::length_t r = 0; r < 4; ++r) {
        Quad exact = 0;
        for (glm::length_t k = 0; k < 4; ++k) exact += Quad(a[k][r]) * Quad(b[c][k]);
        const double x = static_cast<double>(exact),
                     ulp = std::nextafter(std::fabs(x), INFINITY) - std::fabs(x);
        EXPECT_LE(std::fabs(static_cast<double>(Quad(got[c][r]) - exact)), 0.50001 * ulp);
        worst_plain = std::max(worst_plain, std::fabs(static_cast<double>(Quad(plain[c][r]) - exact)) / ulp);
      }
  }
  EXPECT_GT(worst_plain, 10);
}

TEST(TransformCompose, SaysThatASingularMapCannotBeUndone) {
  glm::dmat4 flat(1.0);
  flat[2][2] = 0;
  EXPECT_EQ(
      test::run_node(nodes::transform_compose(), Json::object(), {{matrix(flat)}}).at(1).as<Number>()->value,
      0);
}

}  // namespace
}  // namespace frustum
