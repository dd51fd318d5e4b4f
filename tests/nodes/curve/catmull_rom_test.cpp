#include "nodes/curve/catmull_rom.h"

#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using test::Rational;
constexpr kernels::KnotSide before = kernels::KnotSide::before;

Ref<Curve> through(std::span<const glm::dvec3> p, Json more = Json::object()) {
  more["points"] = test::rows(p);
  return test::run_double(nodes::curve_catmull_rom(), more)[0].as<Curve>();
}

TEST(CurveCatmullRom, HasTheMatrixOfTheTextbookWithoutAnyResidual) {
  // (1, u, u^2, u^3) M (p0 p1 p2 p3): M for tension s.
  const std::vector<Rational> p{Rational(2, 3), Rational(-1), Rational(7, 5), Rational(4)},
      steps(3, Rational(1));
  for (const Rational& s : {Rational(1, 2), Rational(0), Rational(1), Rational(-2, 3)}) {
    auto b = catmull_rom::bezier_points(std::span<const Rational>(p), std::span<const Rational>(steps), s);
    const auto a = kernels::power_of_bezier(std::span<const Rational>(b));
    EXPECT_EQ(a[0], p[1]);
    EXPECT_EQ(a[1], Rational(s * (p[2] - p[0])));
    EXPECT_EQ(a[2], Rational(2 * s * p[0] + (s - 3) * p[1] + (3 - 2 * s) * p[2] - s * p[3]));
    EXPECT_EQ(a[3], Rational(-s * p[0] + (2 - s) * p[1] + (s - 2) * p[2] + s * p[3]));
  }
}

TEST(CurveCatmullRom, IsThePyramidOfBarryAndGoldmanAtAnyKnots) {
  const std::vector<Rational> p{Rational(2, 3), Rational(-1), Rational(7, 5), Rational(4)};
  const std::vector<Rational> h{Rational(1, 2), Rational(3), Rational(5, 7)};
  auto b =
      catmull_rom::bezier_points(std::span<const Rational>(p), std::span<const Rational>(h), Rational(1, 2));
  const Rational k[] = {0, h[0], h[0] + h[1], h[0] + h[1] + h[2]};
  for (const Rational& u : {Rational(0), Rational(1, 3), Rational(3, 4), Rational(1)}) {
    const Rational t = k[1] + u * h[1];
    const auto mix = [&](const Rational& x, const Rational& y, std::size_t i, std::size_t j) -> Rational {
      return (x * (k[j] - t) + y * (t - k[i])) / (k[j] - k[i]);
    };
    const Rational a1 = mix(p[0], p[1], 0, 1), a2 = mix(p[1], p[2], 1, 2), a3 = mix(p[2], p[3], 2, 3);
    const Rational want = mix(mix(a1, a2, 0, 2), mix(a2, a3, 1, 3), 1, 2);
    auto d = b;
    EXPECT_EQ(kernels::casteljau(std::span(d), u), want);
  }
}

TEST(CurveCatmullRom, GoesThroughItsPointsWithOneTangent) {
  std::mt19937_64 random(1);
  const auto p = test::random_polygon(random, 7);
  for (const char* spacing : {"uniform", "centripetal", "chordal"})
    for (const char* ends : {"reflected", "given", "closed"}) {
      const Ref<Curve> c = through(p, {{"spacing", spacing}, {"ends", ends}});
      const kernels::Spline s = c->spline();
      const std::size_t first = std::string(ends) == "given" ? 1 : 0;
      const std::size_t pieces = std::string(ends) == "closed" ? 7 : std::string(ends) == "given" ? 4 : 6;
      ASSERT_EQ(c->pieces(), pieces);
      for (std::size_t i = 0; i <= pieces; ++i) {
        const double t = s.knots[i == 0 ? 0 : 1 + 3 * i];
        const auto left = test::jet(*c, t, before), right = test::jet(*c, t);
        EXPECT_EQ(left[0], p[(first + i) % 7]);
        EXPECT_EQ(right[0], p[(first + i) % 7]);
        EXPECT_LE(kernels::norm(left[1] - right[1]), 1e-13 * (1 + kernels::norm(left[1])));
      }
      if (std::string(ends) == "closed") {
        EXPECT_LE(kernels::norm(test::jet(*c, s.last(), before)[1] - test::jet(*c, s.first())[1]), 1e-13);
      }
    }
}

TEST(CurveCatmullRom, TensionZeroIsStraightAndHalfIsStandard) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {8, 6, 0}};
  const Ref<Curve> straight = through(p, {{"tension", 0}});
  for (int k = 0; k <= 32; ++k) {
    const double t = k / 32.0;
    const glm::dvec3 at = test::jet(*straight, 1 + t)[0];
    EXPECT_EQ(at.x, 4);
  }
  EXPECT_LE(kernels::norm(test::jet(*through(p), 1)[1] - (p[2] - p[0]) * 0.5), 1e-14);
  EXPECT_LE(kernels::norm(test::jet(*through(p, {{"tension", 1}}), 1)[1] - (p[2] - p[0])), 1e-14);
}

TEST(CurveCatmullRom, CentripetalKnotsMakeNoLoopWhereUniformOnesDo) {
  // Two points close together between far ones: the uniform curve overshoots and turns back on itself.
  const std::vector<glm::dvec3> p{{0, 0, 0}, {10, 0, 0}, {10, 0.5, 0}, {0, 1, 0}};
  const auto turns_back = [&](const char* spacing) {
    const Ref<Curve> c = through(p, {{"spacing", spacing}});
    const double from = c->knots[4], to = c->knots[7];
    bool back = false;
    for (int k = 0; k <= 100; ++k) back = back || test::jet(*c, from + (to - from) * k / 100.0)[1].y < 0;
    return back;
  };
  std::vector<glm::dvec3> q{{0, 0, 0}, {1, 20, 0}, {1.2, 20.1, 0}, {2, 0, 0}};
  const auto overshoot = [&](const char* spacing) {
    const Ref<Curve> c = through(q, {{"spacing", spacing}});
    double most = 0;
    for (int k = 0; k <= 100; ++k)
      most = std::max(most, test::jet(*c, c->knots[4] + (c->knots[7] - c->knots[4]) * k / 100.0)[0].y);
    return most - 20.1;
  };
  EXPECT_FALSE(turns_back("centripetal"));
  EXPECT_GT(overshoot("uniform"), 1.5);
  EXPECT_LT(overshoot("centripetal"), 0.5);
}

TEST(CurveCatmullRom, CoincidentPointsAreDroppedWhereKnotsAreDistances) {
  const std::vector<glm::dvec3> p{{0, 0, 0}, {1, 1, 0}, {1, 1, 0}, {2, 0, 0}, {3, 1, 0}};
  EXPECT_EQ(through(p)->pieces(), 4U);
  EXPECT_EQ(through(p, {{"spacing", "centripetal"}})->pieces(), 3U);
  const std::vector<glm::dvec3> same(4, glm::dvec3(1, 2, 3));
  EXPECT_EQ(
      test::run_error(nodes::curve_catmull_rom(), {{"points", test::rows(same)}, {"spacing", "chordal"}})
          .first,
      "wrong_count");
  EXPECT_EQ(test::jet(*through(same), 1.5)[0], same[0]);
  EXPECT_EQ(test::run_error(nodes::curve_catmull_rom(), {{"points", {{0, 0, 0}}}}).first, "wrong_count");
}

}  // namespace
}  // namespace frustum
