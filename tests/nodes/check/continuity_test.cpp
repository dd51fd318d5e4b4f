#include "nodes/check/continuity.h"

#include "nodes/check.h"
#include "tests/nodes/curve/polygons.h"

namespace frustum {
namespace {

using glm::dvec3;

struct Found {
  double c, g;
  friend bool operator==(const Found&, const Found&) = default;
  friend std::ostream& operator<<(std::ostream& o, const Found& f) { return o << "C" << f.c << " G" << f.g; }
};

std::vector<Found> joints(const std::vector<Curve>& curves, const Json& params = {{"orders", 3}}) {
  std::vector<Buffer> in;
  for (const Curve& c : curves) in.push_back(test::curve_of(c));
  const auto out = test::run_double(nodes::check_continuity(), params, {in});
  const Table& t = *out[0].as<Table>();
  std::vector<Found> all;
  for (std::size_t i = 0; i < t.rows(); ++i)
    all.push_back({t.columns[2].numbers[i], t.columns[3].numbers[i]});
  return all;
}

Curve cubic(std::vector<dvec3> p) { return bezier_chain(std::move(p), 3); }

// The part [a, b] of one cubic, by blossoming: pieces that are one curve.
Curve part(const Curve& c, double a, double b) {
  std::vector<dvec3> p;
  for (const glm::dvec4& h : kernels::bezier_points(c.spline(), 3, a, b)) p.emplace_back(h);
  return cubic(p);
}

const Curve whole = cubic({{0, 0, 0}, {1, 3, 1}, {4, -2, 0}, {5, 1, 2}});

TEST(CheckContinuity, HalvesOfACurveMeetInEveryOrderOfBothKinds) {
  EXPECT_EQ(joints({part(whole, 0, 0.5), part(whole, 0.5, 1)}), (std::vector<Found>{{3, 3}}));
}

TEST(CheckContinuity, UnevenPartsOfACurveMeetGeometricallyAndNotParametrically) {
  EXPECT_EQ(joints({part(whole, 0, 0.25), part(whole, 0.25, 1)}), (std::vector<Found>{{0, 3}}));
}

TEST(CheckContinuity, AStandstillIsC1AndNotG1) {
  // Both derivatives are 0 at the joint (doubled control points), and the curve turns by a right angle there.
  const Curve left = cubic({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 0, 0}}),
              right = cubic({{2, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}});
  EXPECT_EQ(joints({left, right}), (std::vector<Found>{{1, 0}}));
}

TEST(CheckContinuity, TangentsOfOneDirectionAreG1AndOfOppositeOnesNot) {
  const Curve left = cubic({{0, 0, 0}, {1, 1, 0}, {2, 1, 0}, {3, 0, 0}});
  EXPECT_EQ(joints({left, cubic({{3, 0, 0}, {5, -2, 0}, {6, 4, 0}, {9, 0, 0}})}),
            (std::vector<Found>{{0, 1}}));
  EXPECT_EQ(joints({left, cubic({{3, 0, 0}, {2, 1, 0}, {6, 4, 0}, {9, 0, 0}})}),
            (std::vector<Found>{{0, 0}}));
  EXPECT_EQ(joints({left, cubic({{3, 0, 0}, {4, -1, 0}, {6, 4, 0}, {9, 0, 0}})}),
            (std::vector<Found>{{1, 1}}));
  EXPECT_EQ(joints({left, cubic({{3, 0.1, 0}, {4, -1, 0}, {6, 4, 0}, {9, 0, 0}})}),
            (std::vector<Found>{{-1, -1}}));
}

TEST(CheckContinuity, EqualCurvatureIsG2AndAnotherOneIsNot) {
  // Quarter circles of three weights: with another middle point the tangents stay and the curvature does not.
  const auto arc = [](dvec3 a, dvec3 b, dvec3 c, double w) {
    Curve q = bezier_chain({a, b, c}, 2);
    q.weights = {1, w, 1};
    return q;
  };
  const double root = std::sqrt(0.5);
  const Curve first = arc({1, 0, 0}, {1, 1, 0}, {0, 1, 0}, root);
  EXPECT_GE(joints({first, arc({0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, root)})[0].g, 2);
  EXPECT_EQ(joints({first, arc({0, 1, 0}, {-1, 1, 0}, {-1, 0, 0}, 0.5)})[0].g, 1);
}

TEST(CheckContinuity, KnotsAreJointsAndTheLastOneMayClose) {
  const Json p = {{0, 0, 0}, {1, 2, 0}, {3, 1, 0}, {4, -1, 0}, {2, -3, 0}, {0, -1, 0}};
  const auto closed =
      test::run_double(nodes::curve_b_spline(), {{"points", p}, {"knots", "closed"}})[0].as<Curve>();
  EXPECT_EQ(joints({*closed}, {{"orders", 3}, {"closed", true}}), std::vector<Found>(6, {2, 2}));
  EXPECT_EQ(joints({*closed}).size(), 5U);
  // At a tiny parameter as well: pieces are measured by their length.
  Curve fast = *closed;
  for (double& k : fast.knots) k *= 1e-9;
  EXPECT_EQ(joints({fast}), std::vector<Found>(5, {2, 2}));
}

}  // namespace
}  // namespace frustum
