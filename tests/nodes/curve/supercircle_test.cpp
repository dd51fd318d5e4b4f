#include "nodes/curve/supercircle.h"

#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using glm::dvec2;

Table samples(double n, const std::string& form, double a = 1, double b = 1, int count = 64) {
  return *test::run_double(nodes::curve_supercircle(),
                           {{"exponent", n}, {"form", form}, {"radii", {a, b}}, {"samples", count}})[1]
              .as<Table>();
}

TEST(CurveSupercircle, BothFormsMeetTheEquationFromStarsToSquares) {
  for (const double n : {0.1, 2.0 / 3, 1.0, 2.0, 2.5, 4.0, 100.0, 1e6})
    for (const char* form : {"parametric", "implicit"}) {
      const Table t = samples(n, form, 3, 0.25);
      for (std::size_t i = 0; i < t.rows(); ++i)
        EXPECT_LE(std::fabs(t.columns[3].numbers[i]), 8 * 0x1p-52 * (1 + n)) << "n = " << n << ", row " << i;
    }
}

TEST(CurveSupercircle, ThePrintedFormDoesNot) {
  // Exponent 2 / (n - 1), errata E59: off by .23 at n = 2 somewhere; at n = 1 it divides by 0.
  double worst = 0;
  for (int k = 1; k < 90; ++k) {
    const auto [s, c] = kernels::sin_cos_degrees(double(k));
    worst = std::max(worst, std::fabs(supercircle::residual({1, 1}, 2, {c * c * c, s * s * s})));
  }
  EXPECT_GT(worst, 0.2);
}

TEST(CurveSupercircle, KnowsItsFriends) {
  const Table ellipse = samples(2, "parametric", 5, 2), rhombus = samples(1, "parametric");
  for (std::size_t i = 0; i < ellipse.rows(); ++i) {
    const auto [s, c] = kernels::sin_cos_degrees(ellipse.columns[0].numbers[i]);
    EXPECT_NEAR(ellipse.columns[1].numbers[i], 5 * c, 1e-15 * 5);
    EXPECT_NEAR(ellipse.columns[2].numbers[i], 2 * s, 1e-15 * 2);
    EXPECT_NEAR(std::fabs(rhombus.columns[1].numbers[i]) + std::fabs(rhombus.columns[2].numbers[i]), 1,
                1e-15);
  }
}

TEST(CurveSupercircle, PointsOnTheAxesAreExactWhateverTheExponent) {
  for (const double n : {0.1, 1.0, 2.5, 100.0, 1e6})
    for (const char* form : {"parametric", "implicit"}) {
      const Table t = samples(n, form, 3, 2, 4);
      EXPECT_THAT(t.columns[1].numbers, testing::ElementsAre(3, 0, -3, 0, 3));
      EXPECT_THAT(t.columns[2].numbers, testing::ElementsAre(0, 2, 0, -2, 0));
    }
}

TEST(CurveSupercircle, EnclosesTheAreaThatGammaSays) {
  for (const double n : {0.5, 1.0, 2.0, 3.0, 8.0}) {
    const Table t = samples(n, n < 2 ? "parametric" : "implicit", 3, 2, 40000);
    const auto &x = t.columns[1].numbers, &y = t.columns[2].numbers;
    double twice = 0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i) twice += x[i] * y[i + 1] - x[i + 1] * y[i];
    const double want = 4 * 3 * 2 * std::pow(std::tgamma(1 + 1 / n), 2) / std::tgamma(1 + 2 / n);
    EXPECT_NEAR(twice / 2, want, 1e-6 * want) << n;
  }
}

}  // namespace
}  // namespace frustum
