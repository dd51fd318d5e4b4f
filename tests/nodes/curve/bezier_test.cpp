#include "nodes/curve/bezier.h"

#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using bezier::Method;
using test::Rational;

constexpr Method all_methods[] = {Method::matrix, Method::volk_schumaker, Method::bernstein,
                                  Method::casteljau, Method::compensated};

TEST(CurveBezier, MatrixFormIsDeCasteljauWithoutAnyResidual) {
  const std::vector<Rational> p{Rational(3, 7), Rational(-2), Rational(5, 3), Rational(11)};
  const auto a = kernels::power_of_bezier(std::span<const Rational>(p));
  // G M, with the course's M and errata E61's G = [p0 p1 p2 p3].
  const int m[4][4] = {{1, -3, 3, -1}, {0, 3, -6, 3}, {0, 0, 3, -3}, {0, 0, 0, 1}};
  for (std::size_t k = 0; k < 4; ++k) {
    Rational sum = 0;
    for (std::size_t i = 0; i < 4; ++i) sum += p[i] * m[i][k];
    EXPECT_EQ(a[k], sum);
  }
  for (const Rational& t : {Rational(0), Rational(1), Rational(1, 3), Rational(-5, 2), Rational(17, 4)}) {
    auto d = p;
    const Rational value = kernels::casteljau(std::span(d), t);
    EXPECT_EQ(value, kernels::horner(std::span<const Rational>(a), t));
    EXPECT_EQ(value, test::bernstein_sum(p, t));
  }
  EXPECT_EQ(kernels::bezier_of_power(std::span<const Rational>(a)), p);
}

TEST(CurveBezier, HasTheTriangleOfTheTextbook) {
  const auto out = test::run_node(nodes::curve_bezier(),
                                  {{"points", {{0, 0, 0}, {0, 8, 0}, {8, 8, 0}, {8, 0, 0}}}, {"t", {0.5}}});
  EXPECT_EQ(out[1].as<Points>()->at[0], glm::dvec3(4, 6, 0));
  const Table& triangle = *out[2].as<Table>();
  ASSERT_EQ(triangle.rows(), 10U);
  EXPECT_THAT(triangle.columns[4].numbers, testing::ElementsAre(0, 0, 8, 8, 0, 4, 8, 2, 6, 4));
  EXPECT_THAT(out[3].as<Table>()->columns[3].numbers, testing::ElementsAre(0.125, 0.375, 0.375, 0.125));
}

template <class R>
void expect_basis(std::size_t n) {
  const double u = hard::unit_roundoff<R>;
  for (const double t : {0.0, 1.0, 0.5, 0.125, 0.9375, 0x1p-10, 1 - 0x1p-12}) {
    const std::vector<R> b = kernels::bernstein(n, static_cast<R>(t)),
                         mirrored = kernels::bernstein(n, static_cast<R>(1 - t));
    double sum = 0;
    for (std::size_t i = 0; i <= n; ++i) {
      std::vector<Rational> one(n + 1, Rational(0));
      one[i] = 1;
      const Rational want = test::bernstein_sum(one, Rational(t));
      const double size = std::max(want.get_d(), double(std::numeric_limits<R>::min()) / u);
      EXPECT_LE(test::off(b[i], want), 2 * double(n + 3) * u * size)
          << "degree " << n << ", " << i << " at " << t;
      EXPECT_GE(b[i], 0);
      EXPECT_NEAR(b[i], mirrored[n - i], 4 * double(n + 3) * u * size);
      sum += double(b[i]);
    }
    EXPECT_NEAR(sum, 1, 2 * double(n + 1) * u);
  }
}

TEST(CurveBezier, BernsteinPolynomialsOfAnyDegreeAreRightToTheLastDigits) {
  for (const std::size_t n : {0U, 1U, 2U, 3U, 17U, 100U, 126U})
    expect_basis<double>(n), expect_basis<float>(n);
  // binomial(1030, 515) is beyond double, and binomial(126, 63) beyond single precision.
  double sum = 0;
  for (const double b : kernels::bernstein(1030, 0.5)) sum += b;
  EXPECT_NEAR(sum, 1, 2e-13);
  Rational mode = 1;
  for (unsigned long i = 1; i <= 515; ++i) mode = mode * (515 + i) / (4 * i);
  EXPECT_LE(test::off(kernels::bernstein(1030, 0.5)[515], mode), 2 * 1033 * 0x1p-53 * mode.get_d());
}

TEST(CurveBezier, BernsteinPolynomialsChangeSignBeyondTheirInterval) {
  for (const double t : {-0.5, 1.5, -2.0, 3.0}) {
    const auto b = kernels::bernstein(5, t);
    double sum = 0, least = 0;
    for (const double x : b) sum += x, least = std::min(least, x);
    EXPECT_LT(least, 0) << "errata E62";
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

// Bounds on the error in u max|P|, as nodes/curve/bezier.h states them.
double bound(Method m, double n) {
  switch (m) {
    case Method::matrix: return std::pow(3, n) * (2 * n + 3);
    case Method::volk_schumaker:
    case Method::bernstein: return 6 * n + 10;
    case Method::casteljau: return 3 * n + 1;
    case Method::compensated: return 1.01;
  }
  return 0;
}

template <class R>
void expect_agreement(std::size_t n, std::mt19937_64& random) {
  auto p = test::random_polygon(random, n + 1, 100);
  for (glm::dvec3& q : p) q = glm::dvec3(glm::vec<3, R>(q));
  std::uniform_real_distribution<double> in(0, 1);
  const R t = static_cast<R>(in(random));
  for (const Method m : all_methods) {
    const auto got = bezier::Evaluator<R>(p, m).at(double(t));
    for (glm::length_t k = 0; k < 3; ++k) {
      const Rational want = test::bernstein_sum(test::coordinate(p, k), Rational(double(t)));
      EXPECT_LE(test::off(double(got[k]), want),
                bound(m, double(n)) * hard::unit_roundoff<R> * test::largest(p))
          << "degree " << n << ", method " << int(m) << ", t " << t;
    }
  }
}

TEST(CurveBezier, AllMethodsAreTheSamePolynomial) {
  std::mt19937_64 random(1);
  for (const std::size_t n : {1U, 2U, 3U, 5U, 10U, 20U})
    for (int trial = 0; trial < 30; ++trial)
      expect_agreement<double>(n, random), expect_agreement<float>(n, random);
}

TEST(CurveBezier, TheMatrixFormLosesTheDigitsThatItsBoundSays) {
  std::mt19937_64 random(2);
  const auto p = test::random_polygon(random, 41);
  const auto off = [&](Method m) {
    return test::off(bezier::Evaluator<double>(p, m).at(0.9).x,
                     test::bernstein_sum(test::coordinate(p, 0), Rational(0.9)));
  };
  EXPECT_GT(off(Method::matrix), 1e4 * off(Method::casteljau))
      << "degree 40: the power basis is ill-conditioned";
}

TEST(CurveBezier, EndsAndConstantsKeepTheirBits) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const auto p = test::random_polygon(random, 4);
    for (const Method m : {Method::bernstein, Method::casteljau, Method::compensated}) {
      bezier::Evaluator<double> e(p, m);
      EXPECT_EQ(e.at(0), p.front());
      EXPECT_EQ(e.at(1), p.back()) << "a + (b - a) t misses it once in six times";
    }
    const std::vector<glm::dvec3> same(5, p[0]);
    const double t = std::fabs(p[1].x);
    EXPECT_EQ(bezier::Evaluator<double>(same, Method::casteljau).at(t), p[0]);
    EXPECT_EQ(bezier::Evaluator<double>(same, Method::compensated).at(t), p[0]);
  }
}

TEST(CurveBezier, StaysInTheBoxOfItsPointsAndMovesWithThem) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> in(0, 1);
  for (int trial = 0; trial < 500; ++trial) {
    const auto p = test::random_polygon(random, 6);
    glm::dvec3 low = p[0], high = p[0];
    for (const auto& q : p) low = glm::min(low, q), high = glm::max(high, q);
    const double t = in(random);
    const glm::dvec3 at = bezier::Evaluator<double>(p, Method::casteljau).at(t);
    EXPECT_EQ(glm::min(glm::max(at, low), high), at);
    // An affine map of the points is one of the curve.
    const glm::dvec3 x = test::random_row(random), y = test::random_row(random), z = test::random_row(random),
                     o = test::random_row(random, 10);
    const auto map = [&](const glm::dvec3& q) { return x * q.x + y * q.y + z * q.z + o; };
    std::vector<glm::dvec3> moved;
    for (const auto& q : p) moved.push_back(map(q));
    const glm::dvec3 away = bezier::Evaluator<double>(moved, Method::casteljau).at(t) - map(at);
    EXPECT_LE(kernels::norm(away), 40 * 0x1p-53 * test::largest(moved));
  }
}

TEST(CurveBezier, TwiceTheDigitsKeepTheSignNearAMultipleRoot) {
  // (t - 3/4)^7 (t - 1)^10: its coefficients round to double; the oracle has the rounded ones.
  std::vector<Rational> a{Rational(1)};
  const auto times = [&](const Rational& root) {
    a.emplace_back(0);
    for (std::size_t i = a.size(); i-- > 0;) a[i] = (i > 0 ? a[i - 1] : Rational(0)) - root * a[i];
  };
  for (int i = 0; i < 7; ++i) times(Rational(3, 4));
  for (int i = 0; i < 10; ++i) times(Rational(1));
  std::vector<double> c;
  for (const Rational& b : kernels::bezier_of_power(std::span<const Rational>(a))) c.push_back(b.get_d());
  const std::vector<Rational> exact(c.begin(), c.end());
  double plain_worst = 0, worst = 0;
  for (int k = -200; k <= 200; ++k) {
    const double t = 0.75 + k * 0x1p-13;
    const Rational want = test::bernstein_sum(exact, Rational(t));
    auto d = c;
    const double size = std::fabs(want.get_d());
    plain_worst = std::max(plain_worst, test::off(kernels::casteljau(std::span(d), t), want) / size);
    const double got = kernels::casteljau_compensated(std::span<const double>(c), t);
    worst = std::max(worst, test::off(got, want) / size);
  }
  EXPECT_LE(worst, 0x1p-52);
  EXPECT_GT(plain_worst, 0.01);
}

TEST(CurveBezier, PiecesOfAChainShareTheirJointsAndEveryBasisGoesThroughOneEvaluator) {
  std::mt19937_64 random(5);
  const auto p = test::random_polygon(random, 7);
  const Curve chain = bezier_chain(p, 3);
  kernels::SplinePoints<double> curve(chain.spline());
  EXPECT_EQ(curve.at(1), p[3]);
  EXPECT_EQ(curve.at(0), p[0]);
  EXPECT_EQ(curve.at(2), p[6]);
  for (int k = 0; k <= 64; ++k) {
    const double t = k / 64.0;
    EXPECT_EQ(curve.at(1 + t),
              bezier::Evaluator<double>(std::span(p).subspan(3, 4), Method::casteljau).at(t));
  }
  // Derivatives at the ends are n (P1 - P0) and n (n - 1) (P2 - 2 P1 + P0).
  std::vector<glm::dvec3> d(5);
  curve.at(0, d);
  EXPECT_EQ(d[1], (p[1] - p[0]) * 3.0);
  EXPECT_LE(kernels::norm(d[2] - ((p[2] - p[1]) - (p[1] - p[0])) * 6.0), 1e-14);
  EXPECT_EQ(d[4], glm::dvec3(0));
}

TEST(CurveBezier, TakesOnePointAndSaysWhatItCannotTake) {
  const auto out = test::run_node(nodes::curve_bezier(), {{"points", {{1, 2, 3}}}, {"t", {0, 0.5, 7}}});
  for (const glm::dvec3& p : out[1].as<Points>()->at) EXPECT_EQ(p, glm::dvec3(1, 2, 3));
  EXPECT_EQ(test::run_error(nodes::curve_bezier(), {{"points", Json::array()}}).first, "wrong_count");
  const Json five = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 1, 0}};
  EXPECT_EQ(test::run_error(nodes::curve_bezier(), {{"points", five}, {"degree", 3}}).first, "wrong_count");
  Json many = Json::array();
  for (int i = 0; i < 120; ++i) many.push_back({i, i % 7, 0});
  EXPECT_EQ(test::run_error(nodes::curve_bezier(), {{"points", many}, {"method", "matrix"}}).first,
            "too_large");
  EXPECT_EQ(test::run_error(nodes::curve_bezier(), {{"points", many}, {"t", {0.5}}}).first, "");
}

TEST(CurveBezier, HugeAndUnusablePointsStayWhereTheyAre) {
  const std::vector<glm::dvec3> huge{{-1e308, 1e308, 0}, {1e308, 1e308, 0}, {1e308, -1e308, 0}};
  const glm::dvec3 at = bezier::Evaluator<double>(huge, Method::casteljau).at(0.5);
  EXPECT_NEAR(at.x / 1e308, 0.5, 1e-15);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<glm::dvec3> broken{{0, 0, 0}, {nan, 1, 0}, {1, 2, 0}};
  const glm::dvec3 half = bezier::Evaluator<double>(broken, Method::casteljau).at(0.5);
  EXPECT_TRUE(std::isnan(half.x));
  EXPECT_EQ(half.y, 1);
}

}  // namespace
}  // namespace frustum
