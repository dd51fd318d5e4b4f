#include "nodes/curve/b_spline.h"

#include "nodes/kernels/bezier.h"
#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using test::Rational;
constexpr kernels::KnotSide before = kernels::KnotSide::before;

Ref<Curve> spline(std::span<const glm::dvec3> p, int degree, Json more = Json::object()) {
  more["points"] = test::rows(p), more["degree"] = degree;
  return test::run_double(nodes::curve_b_spline(), more)[0].as<Curve>();
}

// Cox's recurrence as printed, 0 / 0 = 0, closed at the last knot of the domain: every function, from all
// knots.
Rational cox(std::span<const Rational> u, std::size_t i, std::size_t p, const Rational& t,
             const Rational& last) {
  if (p == 0) {
    const bool inside = t == last ? u[i] < last && u[i + 1] == last : u[i] <= t && t < u[i + 1];
    return Rational(inside ? 1 : 0);
  }
  Rational sum = 0;
  if (u[i + p] != u[i]) sum += (t - u[i]) / (u[i + p] - u[i]) * cox(u, i, p - 1, t, last);
  if (u[i + p + 1] != u[i + 1])
    sum += (u[i + p + 1] - t) / (u[i + p + 1] - u[i + 1]) * cox(u, i + 1, p - 1, t, last);
  return sum;
}

const std::vector<std::vector<double>> hard_knots = {{0, 0, 0, 0, .5, 1, 1, 1, 1},
                                                     {0, 0, 0, 0, .5, .5, .5, 1, 1, 1, 1},
                                                     {0, 1, 2, 3, 4, 5, 6, 7, 8},
                                                     {-1, 0, 0, 0.1, 0.1, 0.30000000000000004, 7, 7, 8, 1e6},
                                                     {0, 0, 0, 0, 1e-300, 1, 1, 1, 1}};

TEST(CurveBSpline, AgreesWithCoxsRecurrenceInRationals) {
  std::mt19937_64 random(1);
  for (const auto& knots : hard_knots) {
    const std::size_t n = knots.size() - 4;
    const auto p = test::random_polygon(random, n);
    const std::vector<Rational> u(knots.begin(), knots.end());
    const Ref<Curve> c = spline(p, 3, {{"knots", "given"}, {"knot_values", knots}});
    for (int k = 0; k <= 40; ++k) {
      const double first = knots[3], last = knots[n], t = k == 40 ? last : first + (last - first) * k / 40.0;
      const auto span = c->spline().span_at(t);
      const auto got = b_spline::basis(c->spline().knots_of(span), t);
      double sum = 0;
      std::array<Rational, 3> want{};
      for (std::size_t i = 0; i < n; ++i) {
        const Rational exact = cox(u, i, 3, Rational(t), u[n]);
        for (glm::length_t a = 0; a < 3; ++a) want[std::size_t(a)] += exact * Rational(p[i][a]);
        const bool counts = i + 3 >= span && i <= span;
        if (!counts) {
          EXPECT_EQ(exact, 0) << "local support";
          continue;
        }
        const double share = got[i + 3 - span];
        EXPECT_GE(share, 0);
        EXPECT_LE(test::off(share, exact), 12 * 0x1p-53 * exact.get_d() + 1e-300);
        sum += share;
      }
      EXPECT_NEAR(sum, 1, 12 * 0x1p-53) << "at " << t;
      const glm::dvec3 at = test::jet(*c, t)[0];
      for (glm::length_t a = 0; a < 3; ++a)
        EXPECT_LE(test::off(at[a], want[std::size_t(a)]), 12 * 0x1p-53 * test::largest(p));
    }
  }
}

TEST(CurveBSpline, TheRecurrenceInRationalsIsTheAlgorithmInRationals) {
  const std::vector<Rational> u{0, 0, 0, Rational(1, 3), Rational(1, 2), 1, 1, 1},
      p{2, -1, Rational(5, 7), 3, 9};
  for (const Rational& t : {Rational(0), Rational(2, 5), Rational(1, 2), Rational(3, 4)}) {
    Rational want = 0;
    for (std::size_t i = 0; i < 5; ++i) want += cox(u, i, 2, t, 1) * p[i];
    std::size_t span = 2;
    while (span < 4 && u[span + 1] <= t) ++span;
    std::vector<Rational> d(p.begin() + long(span) - 2, p.begin() + long(span) + 1);
    EXPECT_EQ(kernels::de_boor(std::span(d), std::span<const Rational>(u).subspan(span - 1, 4), t), want);
  }
}

TEST(CurveBSpline, LosesOneOrderOfSmoothnessWithEveryRepetition) {
  std::mt19937_64 random(2);
  for (std::size_t m = 1; m <= 3; ++m) {
    std::vector<double> knots{0, 0, 0, 0};
    knots.insert(knots.end(), m, 1.0);
    knots.insert(knots.end(), 4, 2.0);
    const Ref<Curve> c =
        spline(test::random_polygon(random, 4 + m), 3, {{"knots", "given"}, {"knot_values", knots}});
    const auto left = test::jet(*c, 1, before), right = test::jet(*c, 1);
    for (std::size_t k = 0; k < 3; ++k) {
      const double gap = kernels::norm(left[k] - right[k]);
      if (k <= 3 - m)
        EXPECT_LE(gap, 1e-13) << "errata E70: C^(3 - " << m << ")";
      else
        EXPECT_GT(gap, 1e-3);
    }
  }
}

TEST(CurveBSpline, DerivativesAreThoseOfTheCurve) {
  std::mt19937_64 random(3);
  const auto p = test::random_polygon(random, 8);
  const Ref<Curve> c = spline(p, 4);
  for (const double t : {0.3, 1.0, 1.7, 3.9}) {
    const double h = 1e-4;
    const auto at = test::jet(*c, t), up = test::jet(*c, t + h), down = test::jet(*c, t - h);
    EXPECT_LE(kernels::norm((up[0] - down[0]) / (2 * h) - at[1]), 1e-6);
    EXPECT_LE(kernels::norm((up[0] - at[0] * 2.0 + down[0]) / (h * h) - at[2]), 1e-2);
  }
}

TEST(CurveBSpline, PiecesAsBezierCurvesAreTheSameCurve) {
  std::mt19937_64 random(4);
  const Ref<Curve> c = spline(test::random_polygon(random, 9), 3, {{"knots", "uniform"}});
  const kernels::Spline s = c->spline();
  for (const std::size_t span : kernels::spans_of(s)) {
    const double a = s.knots[span], b = s.knots[span + 1];
    auto bezier = kernels::bezier_points(s, span, a, b);
    for (const double t : {0.0, 0.25, 0.7, 1.0}) {
      auto d = bezier;
      EXPECT_LE(
          kernels::norm(glm::dvec3(kernels::casteljau(std::span(d), t)) - test::jet(*c, a + (b - a) * t)[0]),
          1e-14);
    }
  }
}

TEST(CurveBSpline, ClosedCurvesMeetThemselvesSmoothly) {
  std::mt19937_64 random(5);
  const auto p = test::random_polygon(random, 6);
  const Ref<Curve> c = spline(p, 3, {{"knots", "closed"}});
  const auto end = test::jet(*c, c->spline().last(), before), start = test::jet(*c, c->spline().first());
  for (std::size_t k = 0; k < 3; ++k) EXPECT_LE(kernels::norm(end[k] - start[k]), 1e-13);
  EXPECT_EQ(c->pieces(), 6U);
}

TEST(CurveBSpline, StaysInTheBoxOfThePointsThatCountAndKeepsAConstant) {
  std::mt19937_64 random(6);
  const std::vector<glm::dvec3> same(7, test::random_row(random, 1e7));
  const Ref<Curve> c = spline(same, 3);
  for (int k = 0; k <= 100; ++k) EXPECT_EQ(test::jet(*c, 4 * k / 100.0)[0], same[0]);
  const auto p = test::random_polygon(random, 7);
  const Ref<Curve> clamped = spline(p, 3);
  EXPECT_EQ(test::jet(*clamped, 0)[0], p.front());
  EXPECT_EQ(test::jet(*clamped, 4, before)[0], p.back());
}

TEST(CurveBSpline, RefusesKnotsThatMakeNoCurve) {
  const Json five = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 1, 0}};
  const auto error = [&](const std::vector<double>& knots) {
    return test::run_error(nodes::curve_b_spline(),
                           {{"points", five}, {"degree", 2}, {"knots", "given"}, {"knot_values", knots}})
        .first;
  };
  EXPECT_EQ(error({0, 0, 0, 1, 2, 3, 3, 3}), "");
  EXPECT_EQ(error({0, 0, 0, 1, 2, 3, 3}), "wrong_count");
  EXPECT_EQ(error({0, 0, 0, 2, 1, 3, 3, 3}), "bad_knots");
  EXPECT_EQ(error({0, 0, 1, 1, 1, 3, 3, 3}), "") << "begins at 1";
  const Json apart = {{"points", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 1, 0}, {5, 1, 0}}},
                      {"degree", 2},
                      {"knots", "given"},
                      {"knot_values", {0, 0, 0, 1, 1, 1, 3, 3, 3}}};
  EXPECT_EQ(test::run_error(nodes::curve_b_spline(), apart).first, "bad_knots") << "falls apart at 1";
  EXPECT_EQ(error({0, 0, 0, 0, 0, 0, 0, 0}), "bad_knots");
  EXPECT_EQ(error({0, 0, 0, 1, 2, 3, 3, 1e200}), "not_finite");
  EXPECT_EQ(test::run_error(nodes::curve_b_spline(), {{"points", five}, {"degree", 5}}).first, "wrong_count");
}

}  // namespace
}  // namespace frustum
