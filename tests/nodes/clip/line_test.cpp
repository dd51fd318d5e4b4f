// clip.line against Cohen and Sutherland's clipper in rational arithmetic, which goes another way: it moves
// ends.
#include "nodes/clip/line.h"

#include "nodes/clip.h"
#include "runtime/buffers/points.h"
#include "runtime/buffers/value.h"
#include "tests/hard/exact.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <bit>
#include <random>

namespace frustum {
namespace {

using clip::Part;
using hard::Rational;
using Exact4 = std::array<Rational, 4>;
constexpr double inf = std::numeric_limits<double>::infinity(),
                 nan = std::numeric_limits<double>::quiet_NaN();

std::optional<Part> cut(const glm::dvec4& p, const glm::dvec4& q, std::span<const glm::dvec4> planes) {
  return clip::clip_segment(p, q, planes, [](const clip::Crossing&) {});
}

Exact4 exact(const glm::dvec4& p) { return {p.x, p.y, p.z, p.w}; }
Rational distance(const glm::dvec4& n, const Exact4& p) {
  Rational sum = 0;
  for (std::size_t i = 0; i < 4; ++i) sum += Rational(n[static_cast<glm::length_t>(i)]) * p[i];
  return sum;
}

struct ExactPart {
  Rational from, to;
};

// Ends outside a plane are moved onto it, plane after plane, until the outcodes of both are empty or share a
// bit.
std::optional<ExactPart> cohen_sutherland(const glm::dvec4& p, const glm::dvec4& q,
                                          std::span<const glm::dvec4> planes) {
  const Exact4 a = exact(p), b = exact(q);
  ExactPart t{0, 1};
  const auto at = [&](const Rational& s) {
    Exact4 x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = a[i] + s * (b[i] - a[i]);
    return x;
  };
  const auto outcode = [&](const Rational& s) {
    unsigned code = 0;
    const Exact4 x = at(s);
    for (std::size_t k = 0; k < planes.size(); ++k) code |= distance(planes[k], x) < 0 ? 1U << k : 0U;
    return code;
  };
  for (;;) {
    const unsigned one = outcode(t.from), two = outcode(t.to);
    if ((one | two) == 0) return t;
    if ((one & two) != 0) return std::nullopt;
    const unsigned outside = one != 0 ? one : two;
    const glm::dvec4& plane = planes[static_cast<std::size_t>(std::countr_zero(outside))];
    const Rational d0 = distance(plane, a), d1 = distance(plane, b);
    (one != 0 ? t.from : t.to) = Rational(d0 / (d0 - d1));
    if (t.from > t.to) return std::nullopt;
  }
}

// Ends on a coarse grid, so that crossings coincide, lie in corners, and run along planes.
class Ends {
 public:
  glm::dvec4 coarse(double w) {
    std::uniform_int_distribution<int> in(-6, 6);
    return {in(random_) / 2.0, in(random_) / 2.0, in(random_) / 2.0, w == 0 ? in(random_) / 4.0 : w};
  }
  glm::dvec4 fine(double w) {
    std::uniform_real_distribution<double> in(-3, 3);
    return {in(random_), in(random_), in(random_), w == 0 ? in(random_) / 2 : w};
  }

 private:
  std::mt19937_64 random_{3};
};

void expect_exact(const glm::dvec4& p, const glm::dvec4& q, std::span<const glm::dvec4> planes) {
  const auto want = cohen_sutherland(p, q, planes);
  const auto got = cut(p, q, planes);
  ASSERT_EQ(got.has_value(), want.has_value()) << p.x << " " << p.y << " " << p.z << " " << p.w << " to "
                                               << q.x << " " << q.y << " " << q.z << " " << q.w;
  if (!want) return;
  const auto near = [](double t, const Rational& exact) {
    return std::fabs(hard::distance(t, exact)) <= 0x1p-52 * std::max(std::fabs(t), 0x1p-900);
  };
  EXPECT_TRUE(near(got->t_from, want->from)) << got->t_from << " " << want->from.get_d();
  EXPECT_TRUE(near(got->t_to, want->to)) << got->t_to << " " << want->to.get_d();
  const auto crossing = [&](std::size_t plane) {
    const Rational d0 = distance(planes[plane], exact(p)), d1 = distance(planes[plane], exact(q));
    return Rational(d0 / (d0 - d1));
  };
  if (got->from_plane) {
    EXPECT_LT(distance(planes[*got->from_plane], exact(p)), 0) << "the plane has the end outside";
    EXPECT_TRUE(crossing(*got->from_plane) == want->from) << "the plane that cuts last, not nearly last";
  }
  if (got->to_plane) {
    EXPECT_LT(distance(planes[*got->to_plane], exact(q)), 0);
    EXPECT_TRUE(crossing(*got->to_plane) == want->to);
  }
}

TEST(ClipLine, LeavesWhatCohenAndSutherlandLeaveInRationals) {
  Ends ends;
  const auto volume = clip::volume_planes({}),
             reversed = clip::volume_planes({.depth = kernels::DepthRange::one_to_zero}),
             window = clip::rectangle_planes({-1, -0.5}, {1.5, 1});
  for (int i = 0; i < 4000; ++i) {
    expect_exact(ends.coarse(0), ends.coarse(0), volume);
    expect_exact(ends.coarse(1), ends.coarse(1), window);
    expect_exact(ends.fine(0), ends.fine(0), reversed);
    expect_exact(ends.fine(1), ends.fine(1), window);
  }
}

// Liang and Barsky as printed, with rounded quotients.
bool printed_form_leaves_something(const glm::dvec4& p, const glm::dvec4& q,
                                   std::span<const glm::dvec4> planes) {
  double t0 = 0, t1 = 1;
  for (const glm::dvec4& n : planes) {
    const double d0 = kernels::dot(n, p), d1 = kernels::dot(n, q), t = d0 / (d0 - d1);
    if (d0 < 0 && d1 < 0) return false;
    if (d0 < 0) t0 = std::max(t0, t);
    if (d1 < 0) t1 = std::min(t1, t);
  }
  return t0 <= t1;
}

// Segments that pass through a corner of the window up to the last place of their numbers.
TEST(ClipLine, DecidesExactlyAtCornersWhereThePrintedFormIsWrong) {
  const auto window = clip::rectangle_planes({0, 0}, {1, 1});
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> size(0.1, 10);
  int printed_wrong = 0, kept = 0;
  for (int i = 0; i < 3000; ++i) {
    const double a = size(random), b = size(random), s = size(random);
    // Both ends lie on a line through (1, 1), rounded.
    const glm::dvec4 p(1 - a, 1 + b, 0, 1), q(1 + a * s, 1 - b * s, 0, 1);
    expect_exact(p, q, window);
    const bool right = cohen_sutherland(p, q, window).has_value();
    kept += right ? 1 : 0;
    printed_wrong += printed_form_leaves_something(p, q, window) != right ? 1 : 0;
  }
  EXPECT_GT(printed_wrong, 100);
  EXPECT_GT(kept, 500);
}

// Two planes cut such segments at parameters that round to one number.
TEST(ClipLine, NamesThePlaneThatCutsLastOfTwoThatMeetInACorner) {
  const auto window = clip::rectangle_planes({0, 0}, {1, 1});
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> size(0.1, 10);
  int told_apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const double a = size(random), b = size(random), s = size(random) / 100;
    const glm::dvec4 out(1 + a, 1 + b, 0, 1), in(1 - a * s, 1 - b * s, 0, 1);
    expect_exact(out, in, window);
    expect_exact(in, out, window);
    const auto way = [&](glm::length_t k) -> Rational { return Rational(out[k]) - Rational(in[k]); };
    const Rational x = (Rational(out.x) - 1) / way(0), y = (Rational(out.y) - 1) / way(1);
    told_apart += x != y && x.get_d() == y.get_d() ? 1 : 0;
  }
  EXPECT_GT(told_apart, 100);
}

TEST(ClipLine, WhatWasClippedIsNotClippedAgain) {
  Ends ends;
  const auto volume = clip::volume_planes({}), window = clip::rectangle_planes({-1, -0.3}, {1.7, 1});
  int cuts = 0;
  for (int i = 0; i < 20000; ++i) {
    const bool flat = i % 2 == 0;
    const auto once = cut(ends.fine(flat ? 1 : 0), ends.fine(flat ? 1 : 0), flat ? window : volume);
    if (!once) continue;
    cuts += once->from_plane || once->to_plane ? 1 : 0;
    const auto twice = cut(once->from, once->to, flat ? window : volume);
    ASSERT_TRUE(twice);
    EXPECT_FALSE(twice->from_plane || twice->to_plane);
    EXPECT_TRUE(twice->from == once->from && twice->to == once->to);
  }
  EXPECT_GT(cuts, 5000);
}

TEST(ClipLine, SaysWhatEachPlaneDid) {
  const auto window = clip::rectangle_planes({0, 0}, {4, 4});
  std::vector<clip::Crossing> said;
  const auto part = clip::clip_segment({-2, 1, 0, 1}, {6, 5, 0, 1}, window,
                                       [&](const clip::Crossing& c) { said.push_back(c); });
  ASSERT_TRUE(part);
  ASSERT_EQ(said.size(), 5U);
  EXPECT_EQ(said[0].role, clip::Role::enters);
  EXPECT_EQ(said[0].t, 0.25);
  EXPECT_EQ(said[1].role, clip::Role::leaves);
  EXPECT_EQ(said[1].t, 0.75);
  EXPECT_EQ(said[2].role, clip::Role::inside);
  EXPECT_EQ(said[3].role, clip::Role::leaves);  // at t = 0.75 too: the corner (4, 4)
  EXPECT_FALSE(said[3].narrows);
  EXPECT_EQ(part->from, glm::dvec4(0, 2, 0, 1));
  EXPECT_EQ(part->to, glm::dvec4(4, 4, 0, 1));
  EXPECT_EQ(*part->from_plane, 0U);
  EXPECT_EQ(*part->to_plane, 1U);
}

// Hard cases of the row: parallel to a plane, without length, -0, through the eye, not finite.
TEST(ClipLine, HasAnAnswerForSegmentsWithoutCrossings) {
  const auto volume = clip::volume_planes({}), window = clip::rectangle_planes({0, 0}, {1, 1});
  EXPECT_TRUE(cut({0.5, 0.5, 0, 1}, {0.5, 0.5, 0, 1}, window)) << "a point inside";
  EXPECT_TRUE(cut({1, -0.0, 0, 1}, {1, -0.0, 0, 1}, window)) << "a point in a corner";
  EXPECT_FALSE(cut({2, 0.5, 0, 1}, {2, 0.5, 0, 1}, window));
  EXPECT_TRUE(cut({0.2, 1, 0, 1}, {3, 1, 0, 1}, window)) << "along a side";
  EXPECT_FALSE(cut({0.2, std::nextafter(1.0, 2.0), 0, 1}, {3, std::nextafter(1.0, 2.0), 0, 1}, window));
  const auto touching = cut({-1, 0.5, 0, 1}, {0, 0.5, 0, 1}, window);
  ASSERT_TRUE(touching) << "an end on a side";
  EXPECT_EQ(touching->t_from, 1);
  EXPECT_FALSE(cut({0, 0, 0, -1}, {0.1, 0, 0, -2}, volume)) << "behind the eye";
  const auto through = cut({0.1, 0.1, 0, 1}, {0.1, 0.1, 0, -1}, volume);
  ASSERT_TRUE(through) << "through the eye's plane";
  EXPECT_GT(through->to.w, 0);
  EXPECT_FALSE(cut({nan, 0, 0, 1}, {0, 0, 0, 1}, volume));
  EXPECT_FALSE(cut({0, 0, 0, 1}, {0, 0, inf, 1}, volume));
  EXPECT_FALSE(cut({0, 0, 0, 1}, {0, nan, 0, 1}, volume));
}

// ----- the node

TEST(ClipLine, CutsPathsAndTellsWhichPlaneCut) {
  auto points = std::make_shared<Points>();
  points->at = {{-2, 0, 0}, {2, 0, 0}, {2, 5, 0}, {0, 0.5, 0}};
  const auto out =
      test::run_node(nodes::clip_line(), {{"against", "rectangle"}}, {{Ref<Points>(points)}, {}});
  const auto kept = out.at(0).as<Points>();
  ASSERT_EQ(kept->at.size(), 4U);
  EXPECT_EQ(kept->at[0], glm::dvec3(-1, 0, 0));
  EXPECT_EQ(kept->at[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(kept->at[3], glm::dvec3(0, 0.5, 0));
  const auto ends = out.at(1).as<Table>();
  ASSERT_EQ(ends->rows(), 3U);
  EXPECT_EQ(ends->columns[2].texts, (std::vector<std::string>{"yes", "no", "yes"}));
  EXPECT_EQ(ends->columns[4].texts, (std::vector<std::string>{"left", "", "high"}));
  EXPECT_EQ(ends->columns[6].texts, (std::vector<std::string>{"right", "", ""}));
  EXPECT_EQ(out.at(2).as<Table>()->rows(), 5U + 2 + 5) << "the second segment is gone at the right side";
}

TEST(ClipLine, ClipsAfterTheMatrixAndBeforeTheDivide) {
  auto points = std::make_shared<Points>();
  points->at = {{0, 0, -4}, {1, 1, 3}};
  auto matrix = std::make_shared<Matrix>();
  matrix->value = glm::dmat4(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, -1, 0, 0, -1, 0);  // w = -z, z = -1: near at 1
  const auto out =
      test::run_node(nodes::clip_line(), Json::object(), {{Ref<Points>(points)}, {Ref<Matrix>(matrix)}});
  const auto kept = out.at(0).as<Points>();
  ASSERT_EQ(kept->at.size(), 2U);
  EXPECT_EQ(kept->at[0], glm::dvec3(0, 0, -0.25));
  EXPECT_LE(std::fabs(kept->at[1].x), 1);
  EXPECT_EQ(kept->at[1].z, -1) << "the near plane, bit for bit";
}

TEST(ClipLine, RefusesWindowsThatAreNone) {
  EXPECT_EQ(test::run_error(nodes::clip_line(), {{"against", "planes"}}).first, "no_planes");
  EXPECT_EQ(test::run_error(nodes::clip_line(), {{"against", "rectangle"}, {"low", {2, 0}}}).first,
            "empty_rectangle");
}

}  // namespace
}  // namespace frustum
