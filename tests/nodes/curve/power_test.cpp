#include "nodes/curve/power.h"

#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using test::Rational;

TEST(CurvePower, GoesThereAndBackWithoutAnyResidual) {
  std::mt19937_64 random(1);
  for (std::size_t n = 0; n <= 30; ++n) {
    std::vector<Rational> p;
    for (const glm::dvec3& q : test::random_polygon(random, n + 1)) p.emplace_back(q.x);
    const auto a = kernels::power_of_bezier(std::span<const Rational>(p));
    EXPECT_EQ(kernels::bezier_of_power(std::span<const Rational>(a)), p);
  }
}

TEST(CurvePower, MakesTheCurveThatItsCoefficientsSay) {
  // 1 + 2 t - 3 t^3, t^2, 0: powers, not indices.
  const auto out = test::run_double(nodes::curve_power(),
                                    {{"coefficients", {{1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {-3, 0, 0}}}});
  const Curve& c = *out[0].as<Curve>();
  for (const double t : {0.0, 0.25, 0.5, 1.0, 2.0}) {
    const auto d = test::jet(c, t);
    EXPECT_NEAR(d[0].x, 1 + 2 * t - 3 * t * t * t, 1e-14);
    EXPECT_NEAR(d[0].y, t * t, 1e-15);
    EXPECT_NEAR(d[1].x, 2 - 9 * t * t, 1e-13);
    EXPECT_NEAR(d[2].y, 2, 1e-14);
  }
}

TEST(CurvePower, TakesEveryPieceApart) {
  const Curve chain = bezier_chain({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 0, 0}, {5, 5, 0}}, 2);
  const auto out = test::run_double(nodes::curve_power(), Json::object(), {{test::curve_of(chain)}});
  const Table& t = *out[1].as<Table>();
  EXPECT_THAT(t.columns[0].numbers, testing::ElementsAre(0, 0, 0, 1, 1, 1));
  EXPECT_THAT(t.columns[2].numbers, testing::ElementsAre(0, 2, 0, 2, 2, 1));
  EXPECT_THAT(t.columns[3].numbers, testing::ElementsAre(0, 0, 1, 1, -2, 6));
  EXPECT_EQ(out[0].as<Curve>()->points, chain.points);
}

TEST(CurvePower, ItsConditionGrowsLikeThreeToTheDegreeAndIsTold) {
  std::mt19937_64 random(2);
  double last = 1;
  for (const std::size_t n : {5U, 10U, 20U, 30U}) {
    double worst = 0;
    for (int trial = 0; trial < 20; ++trial) {
      const auto p = test::random_polygon(random, n + 1);
      const Curve c = bezier_chain(p, n);
      const auto out = test::run_double(nodes::curve_power(), Json::object(), {{test::curve_of(c)}});
      for (std::size_t i = 0; i <= n; ++i)
        worst = std::max(worst, kernels::norm(out[0].as<Curve>()->points[i] - p[i]) / test::largest(p));
    }
    EXPECT_LE(worst, std::pow(3.0, double(n)) * double(n) * 0x1p-53);
    EXPECT_TRUE(n == 5 || worst > 10 * last) << "degree " << n;
    last = worst;
  }
  Context ctx;
  const auto p = test::random_polygon(random, 31);
  test::run_node(nodes::curve_power(), Json::object(), {{test::curve_of(bezier_chain(p, 30))}}, &ctx);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "ill_conditioned");
}

TEST(CurvePower, RefusesWhatHasNoCoefficients) {
  Curve circle = bezier_chain({{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 2);
  circle.weights = {1, 0.5, 1};
  EXPECT_EQ(test::run_error(nodes::curve_power(), Json::object(), {{test::curve_of(circle)}}).first,
            "rational_curve");
  EXPECT_EQ(test::run_error(nodes::curve_power(), Json::object()).first, "wrong_count");
}

}  // namespace
}  // namespace frustum
