// check.energy: the quadrature against closed forms, and what it says of Phong and Blinn.
#include "nodes/check/energy.h"
#include "nodes/check.h"
#include "nodes/kernels/reflectance.h"
#include "runtime/buffers/material.h"
#include "runtime/buffers/value.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace frustum {
namespace {

using energy::Gauss, energy::highlight_share, energy::Lobe;

TEST(CheckEnergy, GaussIntegratesPolynomialsExactly) {
  for (const std::size_t n : {4u, 16u, 64u, 256u}) {
    const Gauss g(n);
    for (const int degree : {0, 1, 7, static_cast<int>(2 * n - 1)}) {
      double sum = 0;
      for (std::size_t i = 0; i < n; ++i) sum += g.weight[i] * std::pow(g.at[i], degree);
      EXPECT_NEAR(sum * (degree + 1), 1, 1e-13) << n << " " << degree;
    }
  }
}

TEST(CheckEnergy, StraightLightGivesTheClosedForms) {
  const Gauss g(64);
  for (const double e : {0.0, 1.0, 5.5, 32.0, 500.0, 1e5}) {
    EXPECT_NEAR(highlight_share(Lobe::phong, e, 0, g) / kernels::phong_reflectance(e), 1, 1e-12) << e;
    EXPECT_NEAR(highlight_share(Lobe::blinn, e, 0, g) / kernels::blinn_reflectance(e), 1, 1e-3) << e;
  }
}

// Phong with e = 1 at any angle, in closed form: over the hemisphere that v must be in, (1/pi cos) times the integral of max(0, r.v)
// (n.v), which for r at the angle theta from n is (2/3)(pi - theta) cos + (2/3) sin over the lune where both are positive.
TEST(CheckEnergy, ALobeCutByTheHorizonGivesItsClosedForm) {
  const Gauss g(128);
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, 85.0}) {
    const double t = degrees * std::numbers::pi / 180;
    const double closed =
        (2.0 / 3) * ((std::numbers::pi - t) * std::cos(t) + std::sin(t)) / (std::numbers::pi * std::cos(t));
    EXPECT_NEAR(highlight_share(Lobe::phong, 1, t, g) / closed, 1, 1e-4) << degrees;
  }
}

// In the mirror direction a sharp lobe sends back 2 / (e + 2) cos / cos: nearly the same at all angles. Blinn's, whose h moves by
// half of what v moves, four times that at straight light.
TEST(CheckEnergy, SharpLobesKeepTheirShareUntilTheHorizonCutsThem) {
  const Gauss g(64);
  const double straight = highlight_share(Lobe::phong, 1000, 0, g);
  for (const double degrees : {30.0, 60.0})
    EXPECT_NEAR(highlight_share(Lobe::phong, 1000, degrees * std::numbers::pi / 180, g) / straight, 1, 1e-3);
  EXPECT_NEAR(highlight_share(Lobe::blinn, 1000, 0, g) / straight, 4 * 1000.0 / 1004, 1e-9);
}

struct Result {
  Ref<Table> table;
  double excess;
  double at(std::size_t column, std::size_t row) const { return table->columns[column].numbers.at(row); }
};
Result checked(const Material& m, const std::string& params = "{}") {
  const auto out = test::run_geometry(nodes::check_energy(), params,
                                      {{"material", {std::make_shared<const Material>(m)}}});
  return {out.at(0).as<Table>(), out.at(1).as<Number>()->value};
}

TEST(CheckEnergy, SaysByHowMuchASurfaceMakesLight) {
  const Result chalk = checked({.model = Reflection::lambert, .diffuse = glm::dvec3{0.8}});
  EXPECT_EQ(chalk.excess, 0);
  EXPECT_EQ(chalk.table->rows(), 9u);
  for (std::size_t i = 0; i < 9; ++i) EXPECT_DOUBLE_EQ(chalk.at(3, i), 0.8);
  // Phong with a blunt highlight beside much diffuse light: above 1 already for straight light.
  const Result blunt = checked(
      {.model = Reflection::phong, .diffuse = glm::dvec3{0.8}, .specular = glm::dvec3{0.8}, .shininess = 2});
  EXPECT_NEAR(blunt.at(3, 0), 0.8 + 0.8 * 0.5, 1e-9);
  EXPECT_NEAR(blunt.at(4, 0), 0.2, 1e-9);
  EXPECT_GT(blunt.excess, 0.5) << "and much more at 80 degrees";
  // Blinn's lobe of the same exponent is wider: what Phong may do, it may not.
  Material m{
      .model = Reflection::phong, .diffuse = glm::dvec3{0.5}, .specular = glm::dvec3{0.9}, .shininess = 6};
  const double by_phong = checked(m).at(4, 0);
  m.model = Reflection::blinn;
  EXPECT_EQ(by_phong, 0);
  EXPECT_NEAR(checked(m).at(4, 0), 0.9 * kernels::blinn_reflectance(6) - 0.5, 1e-3);
}

TEST(CheckEnergy, CountsTheStrongestChannelAndNothingOfUnlit) {
  const Result red = checked({.model = Reflection::lambert, .diffuse = {1.5, 0.2, 0.1}}, R"({"angles": 1})");
  EXPECT_EQ(red.excess, 0.5);
  EXPECT_EQ(checked({.diffuse = glm::dvec3{3}, .unlit = true}).excess, 0);
}

}  // namespace
}  // namespace frustum
