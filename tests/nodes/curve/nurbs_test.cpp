#include "nodes/curve/nurbs.h"

#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using hard::Real;
using test::Rational;
constexpr kernels::KnotSide before = kernels::KnotSide::before;
const double half_root = std::sqrt(0.5);

Ref<Curve> nurbs(std::span<const glm::dvec3> p, const std::vector<double>& w, Json more = Json::object(),
                 const NodeType& type = nodes::curve_nurbs(), std::vector<Buffer> matrix = {}) {
  more["points"] = test::rows(p), more["weights"] = w;
  return test::run_double(type, more, {{}, std::move(matrix)})[0].as<Curve>();
}

// Nine points on a square, quadratic: the whole circle about a place.
Ref<Curve> circle(double radius, const glm::dvec3& about = glm::dvec3(0)) {
  const int x[] = {1, 1, 0, -1, -1, -1, 0, 1, 1}, y[] = {0, 1, 1, 1, 0, -1, -1, -1, 0};
  std::vector<glm::dvec3> p;
  std::vector<double> w;
  for (int i = 0; i < 9; ++i)
    p.push_back(about + glm::dvec3(x[i], y[i], 0) * radius), w.push_back(i % 2 == 0 ? 1 : half_root);
  return nurbs(p, w, {{"knots", "given"}, {"knot_values", {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}}});
}

TEST(CurveNurbs, AQuarterCircleIsExactAndNoCubicIs) {
  const Real root = hard::sqrt(Real(0.5));
  const std::vector<std::array<Real, 3>> control{
      {Real(1), Real(0), Real(1)}, {Real(1), Real(1), root}, {Real(0), Real(1), Real(1)}};
  const std::vector<Rational> knots{0, 0, 1, 1};
  double worst = 0, cubic_worst = 0;
  for (int k = 0; k <= 256; ++k) {
    const Rational t(k, 256);
    std::array<Real, 3> at;
    for (std::size_t a = 0; a < 3; ++a) {
      std::vector<Real> d;
      for (const auto& c : control) d.push_back(a < 2 ? c[a] * c[2] : c[2]);
      at[a] = kernels::de_boor(std::span(d), std::span<const Rational>(knots), t);
    }
    const Real x = at[0] / at[2], y = at[1] / at[2];
    worst = std::max(worst, std::fabs((hard::sqrt(x * x + y * y) - Real(1)).to_double()));
    // The usual cubic, which touches the circle in its middle, too.
    const double c = 4 * (std::sqrt(2) - 1) / 3, u = k / 256.0, v = 1 - u;
    const double cx = v * v * v + 3 * v * v * u + 3 * v * u * u * c,
                 cy = 3 * v * v * u * c + 3 * v * u * u + u * u * u;
    cubic_worst = std::max(cubic_worst, std::fabs(std::sqrt(cx * cx + cy * cy) - 1));
  }
  EXPECT_LE(worst, 1e-70);
  EXPECT_NEAR(cubic_worst, 2.72529e-4, 2e-8);
}

TEST(CurveNurbs, ACircleIsOneOfAnySizeAnywhere) {
  for (const double radius : {1e-6, 1.0, 1e7})
    for (const double offset : {0.0, 1e7}) {
      const glm::dvec3 about(offset, -offset, 0);
      const Ref<Curve> c = circle(radius, about);
      for (int k = 0; k <= 400; ++k) {
        const glm::dvec3 at = test::jet(*c, k / 100.0)[0] - about;
        EXPECT_NEAR(kernels::norm(at), radius, 8 * 0x1p-53 * (radius + 2 * offset));
      }
    }
}

TEST(CurveNurbs, DerivativesAreTangentToTheCircleAndItsCurvatureIsOneOverTheRadius) {
  const Ref<Curve> c = circle(2);
  for (int k = 0; k < 40; ++k) {
    const auto d = test::jet(*c, k / 10.0 + 0.05);
    EXPECT_NEAR(kernels::dot(d[0], d[1]), 0, 1e-14);
    const double speed = kernels::norm(d[1]);
    EXPECT_NEAR(kernels::norm(kernels::cross(d[1], d[2])) / (speed * speed * speed), 0.5, 1e-14);
  }
}

TEST(CurveNurbs, PerspectiveOfTheCurveIsTheCurveOfThePerspectiveWithItsWeights) {
  const Ref<Curve> c = circle(1, {0, 0, -5});
  glm::dmat4 m(0);  // x' = x / -z, y' = y / -z seen from aside
  m[0][0] = 1.5, m[1][1] = 2, m[2][2] = -1, m[3][2] = -2, m[2][3] = -1, m[0][3] = 0.5;
  const Json kept = {{"knots", "given"}, {"knot_values", c->knots}};
  const auto matrix = Buffer(std::make_shared<const Matrix>(Matrix{m}));
  const Ref<Curve> moved = nurbs(c->points, c->weights, kept, nodes::curve_nurbs(), {matrix});
  // The same points with the weights that they had before: what E71 warns of.
  const Ref<Curve> careless = nurbs(moved->points, c->weights, kept);
  double worst = 0, careless_worst = 0;
  for (int k = 0; k <= 400; ++k) {
    const double t = k / 100.0;
    const glm::dvec4 h = m * glm::dvec4(test::jet(*c, t)[0], 1);
    const glm::dvec3 want = glm::dvec3(h) / h.w;
    worst = std::max(worst, kernels::norm(test::jet(*moved, t)[0] - want));
    careless_worst = std::max(careless_worst, kernels::norm(test::jet(*careless, t)[0] - want));
  }
  EXPECT_LE(worst, 1e-15 * 4);
  EXPECT_GT(careless_worst, 0.005);
}

TEST(CurveNurbs, WeightsOfAnyPositiveSizeKeepItWithinItsPoints) {
  for (const double w : {1e-300, 1e-8, 1.0, 1e8, 1e300}) {
    const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 2, 0}, {2, 0, 0}};
    const Ref<Curve> c = nurbs(p, {1, w, 1});
    for (int k = 0; k <= 64; ++k) {
      const double t = k / 64.0;
      const glm::dvec3 at = test::jet(*c, t)[0];
      const Rational x(t), away = 1 - x, side = away * away + x * x, middle = 2 * x * away * Rational(w);
      const Rational want = (2 * middle) / (side + middle);
      EXPECT_LE(test::off(at.y, want), 16 * 0x1p-53 * 2);
      EXPECT_LE(at.y, 2);
    }
    EXPECT_EQ(test::jet(*c, 0)[0], p[0]);
    EXPECT_EQ(test::jet(*c, 1, before)[0], p[2]);
  }
}

TEST(CurveNurbs, WeightsOfZeroAtTheEndsHaveTheLimit) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 2, 0}, {2, 0, 0}};
  const Ref<Curve> middle = nurbs(p, {0, 1, 0}), last = nurbs(p, {0, 0, 3});
  for (const double t : {0.0, 0.25, 1.0}) {
    EXPECT_EQ(test::jet(*middle, t)[0], p[1]);
    EXPECT_EQ(test::jet(*last, t)[0], p[2]);
  }
  EXPECT_EQ(test::jet(*nurbs(p, {0, 1, 1}), 0)[0], p[1]);
}

TEST(CurveNurbs, PolesAreFoundWhereTheyAre) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 2, 0}, {2, 0, 0}};
  const auto error = [&](const std::vector<double>& w) {
    return test::run_error(nodes::curve_nurbs(), {{"points", test::rows(p)}, {"weights", w}});
  };
  EXPECT_EQ(error({1, -1, 1}).first, "pole") << "a double root at 1/2";
  EXPECT_EQ(error({1, 1, -1}).first, "pole");
  EXPECT_EQ(error({0, 0, 0}).first, "pole");
  EXPECT_EQ(error({1, -0.9, 1}).first, "") << "the denominator stays above 0";
  EXPECT_EQ(error({-1, -2, -1}).first, "") << "all turned around";
  const double w[] = {1, 0.5, -2};
  const auto at = nurbs::root_inside(w, 0, 1);
  ASSERT_TRUE(at.has_value());
  // (1 - t)^2 + t (1 - t) - 2 t^2 = 1 - t - 2 t^2 = (1 - 2 t)(1 + t).
  EXPECT_LE(at->first, 0.5);
  EXPECT_GE(at->second, 0.5);
  EXPECT_LE(at->second - at->first, 1e-12);
  // The other part of the circle: its middle weight is below 0.
  const Ref<Curve> rest = nurbs(std::vector<glm::dvec3>{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {1, -half_root, 1});
  for (int k = 0; k <= 32; ++k) {
    const glm::dvec3 q = test::jet(*rest, k / 32.0)[0];
    EXPECT_NEAR(kernels::norm(q), 1, 1e-14);
    EXPECT_TRUE(k == 0 || k == 32 || q.x < 0.999 || q.y < 0) << "the long way around";
  }
}

TEST(CurveNurbs, LinesStayWithinTheirToleranceOfTheCircle) {
  const auto out = test::run_double(nodes::curve_polyline(), {{"tolerance", 1e-3}}, {{circle(1)}});
  const auto& at = out[0].as<Points>()->at;
  double worst = 0;
  for (std::size_t i = 0; i + 1 < at.size(); ++i)
    worst = std::max(worst, 1 - kernels::norm((at[i] + at[i + 1]) * 0.5));
  EXPECT_LE(worst, 1e-3);
  EXPECT_GT(worst, 1e-5) << "and not cut more than ten times too often";
}

}  // namespace
}  // namespace frustum
