#include "nodes/curve/hermite.h"

#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using test::Rational;
constexpr kernels::KnotSide before = kernels::KnotSide::before;

Ref<Curve> through(std::span<const glm::dvec3> p, std::span<const glm::dvec3> r) {
  return test::run_double(nodes::curve_hermite(), {{"points", test::rows(p)}, {"tangents", test::rows(r)}})[0]
      .as<Curve>();
}

TEST(CurveHermite, InterpolatesEndsAndDerivativesExactly) {
  const Rational p0(3, 7), p3(-5, 2), r0(11, 3), r3(1, 9);
  const auto at = [&](const Rational& u) { return hermite::by_matrix(p0, p3, r0, r3, u); };
  EXPECT_EQ(at(0), p0);
  EXPECT_EQ(at(1), p3);
  // A cubic's derivative at u from four of its values, exactly.
  const auto slope = [&](const Rational& u) -> Rational {
    return (at(u - 2) - 6 * at(u - 1) + 3 * at(u) + 2 * at(u + 1)) / 6;
  };
  EXPECT_EQ(slope(0), r0);
  EXPECT_EQ(slope(1), r3);
}

TEST(CurveHermite, IsTheBezierCurveOfTheSameEndsWithoutAnyResidual) {
  const std::vector<Rational> p{Rational(3, 7), Rational(-5, 2), Rational(8)},
      r{Rational(11, 3), Rational(1, 9), Rational(-4)};
  for (const Rational& step : {Rational(1), Rational(2, 5)}) {
    const auto b = hermite::bezier_points(std::span<const Rational>(p), std::span<const Rational>(r), step);
    ASSERT_EQ(b.size(), 7U);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(hermite::derivative(b[3 * i], b[3 * i + 1], step), r[i])
          << "r0 = 3 (p1 - p0), there and back";
      EXPECT_EQ(hermite::derivative(b[3 * i + 2], b[3 * i + 3], step), r[i + 1]);
      for (const Rational& u : {Rational(0), Rational(1, 3), Rational(1), Rational(7, 2)}) {
        std::vector<Rational> d(b.begin() + 3 * long(i), b.begin() + 3 * long(i) + 4);
        const Rational value = kernels::casteljau(std::span(d), u);
        EXPECT_EQ(value,
                  hermite::by_matrix(p[i], p[i + 1], Rational(r[i] * step), Rational(r[i + 1] * step), u));
      }
    }
  }
}

TEST(CurveHermite, ConversionLosesAtMostTheRoundingOfItsResult) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const double offset = trial % 2 == 0 ? 0 : 1e7, reach = trial % 3 == 0 ? 1e8 : 1;
    const double p[] = {offset + test::random_row(random).x, offset + test::random_row(random).x};
    const double r[] = {reach * test::random_row(random).x, reach * test::random_row(random).x};
    const auto b = hermite::bezier_points(std::span<const double>(p), std::span<const double>(r), 1.0);
    const double size = std::fabs(p[0]) + std::fabs(p[1]) + std::fabs(r[0]) + std::fabs(r[1]);
    EXPECT_LE(test::off(b[1], Rational(p[0]) + Rational(r[0]) / 3), 2 * 0x1p-53 * size);
    EXPECT_LE(test::off(b[2], Rational(p[1]) - Rational(r[1]) / 3), 2 * 0x1p-53 * size);
  }
}

TEST(CurveHermite, JoinsPiecesWithTheSameDerivative) {
  std::mt19937_64 random(2);
  const auto p = test::random_polygon(random, 5), r = test::random_polygon(random, 5, 20);
  const Ref<Curve> c = through(p, r);
  for (std::size_t i = 0; i < 5; ++i)
    for (const auto side : {before, kernels::KnotSide::after}) {
      const auto d = test::jet(*c, double(i), side);
      EXPECT_EQ(d[0], p[i]) << "bit for bit";
      EXPECT_LE(kernels::norm(d[1] - r[i]), 1e-14);
    }
}

TEST(CurveHermite, TellsTheFormOfEveryPieceAndWhatDoesNotMatch) {
  const auto out = test::run_double(
      nodes::curve_hermite(), {{"points", {{0, 0, 0}, {6, 0, 0}}}, {"tangents", {{3, 9, 0}, {3, -9, 0}}}});
  const Table& t = *out[1].as<Table>();
  EXPECT_THAT(t.columns[1].texts, testing::ElementsAre("p0", "p1", "p2", "p3", "r0", "r3"));
  EXPECT_THAT(t.columns[2].numbers, testing::ElementsAre(0, 1, 5, 6, 3, 3));
  EXPECT_THAT(t.columns[3].numbers, testing::ElementsAre(0, 3, 3, 0, 9, -9));
  EXPECT_EQ(
      test::run_error(nodes::curve_hermite(), {{"points", {{0, 0, 0}, {6, 0, 0}}}, {"tangents", {{3, 9, 0}}}})
          .first,
      "rows_differ");
  EXPECT_EQ(
      test::run_error(nodes::curve_hermite(), {{"points", {{0, 0, 0}}}, {"tangents", {{3, 9, 0}}}}).first,
      "wrong_count");
}

}  // namespace
}  // namespace frustum
