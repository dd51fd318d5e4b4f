#include "nodes/curve/polyline.h"

#include "nodes/kernels/bezier.h"
#include "runtime/core/archive.h"
#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using test::Rational;

struct Drawn {
  std::vector<glm::dvec3> at, tangents;
  std::vector<double> t, speed, curvature, bound;
};

Drawn drawn(const Curve& c, const Json& params) {
  Context ctx;
  ctx.precision = Precision::real_double;
  const auto out = test::run_node(nodes::curve_polyline(), params, {{test::curve_of(c)}}, &ctx);
  const Table& s = *out[2].as<Table>();
  return {out[0].as<Points>()->at, out[1].as<Vectors>()->along, s.columns[0].numbers,
          s.columns[4].numbers,    s.columns[5].numbers,        s.columns[6].numbers};
}

// How far the curve leaves each line, at points of equal parameter: for a polynomial what is bounded.
double worst(const Curve& c, const Drawn& d, bool by_parameter = true, double* over_bound = nullptr) {
  kernels::SplinePoints<double> curve(c.spline());
  double most = 0;
  for (std::size_t i = 0; i + 1 < d.t.size(); ++i)
    for (int k = 1; k < 32; ++k) {
      const double s = k / 32.0;
      const glm::dvec3 q = curve.at(d.t[i] * (1 - s) + d.t[i + 1] * s);
      const double off = by_parameter ? kernels::norm(q - (d.at[i] * (1 - s) + d.at[i + 1] * s))
                                      : polyline::distance_to_segment(q, d.at[i], d.at[i + 1]);
      most = std::max(most, off);
      if (over_bound != nullptr) *over_bound = std::max(*over_bound, off - d.bound[i]);
    }
  return most;
}

TEST(CurvePolyline, StaysWithinItsToleranceAndItsBound) {
  std::mt19937_64 random(1);
  for (const std::size_t degree : {1U, 2U, 3U, 4U, 7U})
    for (const double tolerance : {0.5, 0.01, 1e-4}) {
      const Curve c = bezier_chain(test::random_polygon(random, 2 * degree + 1, 10), degree);
      const Drawn d = drawn(c, {{"tolerance", tolerance}});
      double over = -1;
      EXPECT_LE(worst(c, d, true, &over), tolerance);
      EXPECT_LE(over, 1e-13) << "a bound that is none";
      EXPECT_EQ(d.at.front(), c.points.front());
      EXPECT_EQ(d.at.back(), c.points.back());
    }
}

TEST(CurvePolyline, CutsNoMoreThanThePolygonAsksFor) {
  // |P''| is the constant 2 |P2 - 2 P1 + P0| of a parabola: n lines err by |P''| / (8 n^2), neither more
  // nor less.
  const Curve c = bezier_chain({{0, 0, 0}, {1, 2, 0}, {2, 0, 0}}, 2);
  for (const int n : {1, 4, 16}) {
    const Drawn d = drawn(c, {{"cutting", "uniform"}, {"segments", n}});
    EXPECT_NEAR(worst(c, d), 1.0 / (n * n), 1e-14);
    EXPECT_NEAR(d.bound[0], 1.0 / (n * n), 1e-14);
  }
  EXPECT_EQ(drawn(c, {{"tolerance", 1.0 / 64}}).at.size(), 9U);
  EXPECT_EQ(drawn(bezier_chain({{0, 0, 0}, {5, 5, 0}, {10, 10, 0}}, 2), Json::object()).at.size(), 2U);
}

TEST(CurvePolyline, TwiceTheLinesHaveAQuarterOfTheError) {
  std::mt19937_64 random(2);
  const Curve c = bezier_chain(test::random_polygon(random, 6), 5);
  double last = worst(c, drawn(c, {{"cutting", "uniform"}, {"segments", 256}}));
  for (const int n : {512, 1024, 2048}) {
    const double now = worst(c, drawn(c, {{"cutting", "uniform"}, {"segments", n}}));
    EXPECT_NEAR(last / now, 4, 0.05) << n;
    last = now;
  }
}

TEST(CurvePolyline, EndsOnLoopsBacktracksAndCuspsOfAnySize) {
  const std::vector<std::vector<glm::dvec3>> hard = {
      {{0, 0, 0}, {3, 4, 0}, {-3, 4, 0}, {0, 0, 0}},  // both ends at one place: a chord of length 0
      {{0, 0, 0}, {4, 0, 0}, {-3, 0, 0}, {1, 0, 0}},  // there and back along a line
      {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 0}},   // a cusp inside
      {{2, 2, 2}, {2, 2, 2}, {2, 2, 2}, {2, 2, 2}}};
  for (const auto& shape : hard)
    for (const double size : {1.0, 1e7, 1e-30, 1e30}) {
      std::vector<glm::dvec3> p;
      for (const glm::dvec3& q : shape) p.push_back(q * size);
      const Curve c = bezier_chain(p, 3);
      const Drawn d = drawn(c, {{"tolerance", 1e-3 * size}});
      EXPECT_LE(worst(c, d), 1e-3 * size);
      EXPECT_LE(d.at.size(), 257U);
    }
  // A tolerance that no line meets ends at the depth, and says so.
  Context ctx;
  test::run_node(nodes::curve_polyline(), {{"tolerance", 1e-9}, {"depth", 6}},
                 {{test::curve_of(bezier_chain({{0, 0, 0}, {1e30, 1, 0}, {2, 2, 1e30}}, 2))}}, &ctx);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "tolerance_not_met");
}

TEST(CurvePolyline, PointsThatAreNoNumbersAreToldAndNotCutForever) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Context ctx;
  const auto out =
      test::run_node(nodes::curve_polyline(), Json::object(),
                     {{test::curve_of(bezier_chain({{0, 0, 0}, {nan, 1, 0}, {2, 2, 0}}, 2))}}, &ctx);
  EXPECT_EQ(out[0].as<Points>()->at.size(), 2U);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "curve_not_finite");
}

TEST(CurvePolyline, FollowsTheFirstDerivativeThatDoesNotVanish) {
  const auto tangents = [](std::vector<glm::dvec3> p) {
    return drawn(bezier_chain(std::move(p), 3), Json::object()).tangents;
  };
  const auto doubled = tangents({{0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}});
  EXPECT_LE(kernels::norm(doubled.front() - glm::dvec3(0.6, 0.8, 0)), 1e-15);
  EXPECT_LE(kernels::norm(doubled.back() - glm::dvec3(0.6, 0.8, 0)), 1e-15);
  const auto tripled = tangents({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 2, 0}});
  EXPECT_EQ(tripled.front(), glm::dvec3(0, 1, 0));
  const auto point = tangents({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}});
  EXPECT_EQ(point.front(), glm::dvec3(0));
}

TEST(CurvePolyline, MeasuresTheCurvatureOfACurve) {
  // y = x^2 over [-1, 1]: 2 / (1 + 4 x^2)^(3/2).
  const Drawn d =
      drawn(bezier_chain({{-1, 1, 0}, {0, -1, 0}, {1, 1, 0}}, 2), {{"cutting", "uniform"}, {"segments", 8}});
  for (std::size_t i = 0; i < d.at.size(); ++i) {
    EXPECT_NEAR(d.curvature[i], 2 / std::pow(1 + 4 * d.at[i].x * d.at[i].x, 1.5), 1e-14);
    EXPECT_NEAR(d.speed[i], 2 * std::sqrt(1 + 4 * d.at[i].x * d.at[i].x), 1e-14);
  }
}

class Written : public ArchiveWriter {
 public:
  void raw(const void* data, std::size_t bytes) override {
    all.append(static_cast<const char*>(data), bytes);
  }
  void shared(const std::shared_ptr<const void>&, std::size_t) override { FAIL(); }
  std::string all;
};
class Read : public ArchiveReader {
 public:
  explicit Read(std::string all) : all_(std::move(all)) {}
  void raw(void* to, std::size_t bytes) override {
    if (bytes > left()) throw ArchiveError("too short");
    std::copy_n(all_.data() + at_, bytes, static_cast<char*>(to));
    at_ += bytes;
  }
  std::size_t left() const override { return all_.size() - at_; }
  std::shared_ptr<void> shared(std::size_t) override { return nullptr; }

 private:
  std::string all_;
  std::size_t at_ = 0;
};

Ref<Curve> there_and_back(const Curve& c) {
  Written w;
  buffer_type<Curve>().save(&c, w);
  Read r(w.all);
  return buffer_type<Curve>().load(r).as<Curve>();
}

TEST(CurveBuffer, SurvivesTheCacheAndRefusesWhatDoesNotMatch) {
  Curve c = bezier_chain({{0, 1, 2}, {3, 4, 5}, {6, 7, 9}}, 2);
  c.weights = {1, 0.5, 2};
  const Ref<Curve> back = there_and_back(c);
  EXPECT_EQ(back->points, c.points);
  EXPECT_EQ(back->weights, c.weights);
  EXPECT_EQ(back->knots, c.knots);
  Curve other = c;
  EXPECT_EQ(Buffer(test::curve_of(other)).digest(), Buffer(test::curve_of(c)).digest());
  other.weights[1] = 0.25;
  EXPECT_NE(Buffer(test::curve_of(other)).digest(), Buffer(test::curve_of(c)).digest());
  other.knots.pop_back();
  EXPECT_THROW(there_and_back(other), ArchiveError);
  other = c;
  other.degree = 7;
  EXPECT_THROW(there_and_back(other), ArchiveError);
  other.points[1].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(buffer_type<Curve>().health(&other).nan, 1U);
  EXPECT_EQ(buffer_type<Curve>().health(&other).first, "control point 1, y");
}

}  // namespace
}  // namespace frustum
