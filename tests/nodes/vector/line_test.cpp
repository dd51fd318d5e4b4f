#include "nodes/vector/line.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

using test::Quad;

// ----- explicit

TEST(VectorLine, WritesTheExplicitFormOfWhatIsNotVertical) {
  const auto e = vector::explicit_form({1, 5}, {3, 1});
  EXPECT_EQ(e->m, -2);
  EXPECT_EQ(e->b, 7);
  EXPECT_FALSE(vector::explicit_form({2, 0}, {2, 7}));
  EXPECT_FALSE(vector::explicit_form({0, 0}, {1e-300, 1e300})) << "a slope out of range";
}

TEST(VectorLine, KeepsTheDigitsOfTheExplicitForm) {
  std::mt19937_64 random(1);
  double worst_naive = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const glm::dvec3 r = test::random_row(random, 10), s = test::random_row(random, 10);
    const glm::dvec2 p(1e6 + r.x, 0.75e6 + r.y), q(2e6 + s.x, 1.5e6 + s.y);  // b is small: it nearly cancels
    const auto e = vector::explicit_form(p, q);
    const Quad dx = Quad(q.x) - Quad(p.x), m = (Quad(q.y) - Quad(p.y)) / dx;
    const Quad b = (Quad(p.y) * Quad(q.x) - Quad(q.y) * Quad(p.x)) / dx;
    EXPECT_LE(std::fabs(static_cast<double>(Quad(e->m) - m)), test::ulp(e->m));
    EXPECT_LE(std::fabs(static_cast<double>(Quad(e->b) - b)), test::ulp(e->b));
    const double naive = p.y - e->m * p.x;
    worst_naive = std::max(worst_naive, std::fabs(static_cast<double>(Quad(naive) - b)) / test::ulp(e->b));
  }
  EXPECT_GT(worst_naive, 1000);
}

// ----- implicit and sides

TEST(VectorLine, TakesTheSideOfErrataFour) {
  const glm::dvec2 p(0, 0), q(4, 2);
  EXPECT_EQ(vector::implicit_value(p, q, {2, 3}), -8);
  EXPECT_EQ(vector::implicit_value(p, q, {2, 0}), 4);
  EXPECT_EQ(vector::above(p, q, {2, 3}), 1) << "the printed rule says below";
  EXPECT_EQ(vector::above(q, p, {2, 3}), 1) << "whichever way the line runs";
  EXPECT_EQ(vector::side_of(p, q, {2, 3}), 1);
  EXPECT_EQ(vector::side_of(q, p, {2, 3}), -1);
  EXPECT_EQ(vector::side_of(p, q, {2, 1}), 0);
  EXPECT_EQ(vector::above({1, 0}, {1, 5}, {7, 2}), 0) << "beside a vertical line";
}

// Hard case FND-07: the classroom grid of Kettner et al., where plain arithmetic is wrong thousands of times.
TEST(VectorLine, SaysTheSideExactlyOnTheClassroomGrid) {
  const glm::dvec2 q(12, 12), r(24, 24);
  int plain_wrong = 0;
  for (int i = 0; i < 256; ++i)
    for (int k = 0; k < 256; ++k) {
      const glm::dvec2 p(0.5 + i * 0x1p-53, 0.5 + k * 0x1p-53);
      // Above the diagonal is left of the way up. 0.5 + i 2^-53 is rounded for odd i: the numbers that there are count.
      const int exact = p.y > p.x ? 1 : p.y < p.x ? -1 : 0;
      ASSERT_EQ(vector::side_of(q, r, p), exact);
      const double f = vector::plain_implicit_value(q, r, p);
      plain_wrong += (f < 0 ? 1 : f > 0 ? -1 : 0) != exact ? 1 : 0;
    }
  EXPECT_GT(plain_wrong, 1000);
}

TEST(VectorLine, EvaluatesTheImplicitFormNearFarAwayLines) {
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 500; ++trial) {
    const glm::dvec3 a = test::random_row(random, 1e8), b = test::random_row(random, 1e8);
    const glm::dvec2 p(a.x, a.y), q(b.x, b.y), on = p + (q - p) * 0.375;
    const Quad exact = (Quad(on.x) - Quad(p.x)) * (Quad(q.y) - Quad(p.y)) -
                       (Quad(on.y) - Quad(p.y)) * (Quad(q.x) - Quad(p.x));
    const double f = vector::implicit_value(p, q, on);
    EXPECT_LE(std::fabs(static_cast<double>(Quad(f) - exact)),
              std::ldexp(std::fabs(static_cast<double>(exact)), -40) + 1e-12);
  }
}

// ----- meeting

// The point of p and the line through it that the other line's equation gives, with 113 bits.
glm::dvec2 meeting_in_quad(const glm::dvec2& p0, const glm::dvec2& p1, const glm::dvec2& q0,
                           const glm::dvec2& q1) {
  const Quad dx = Quad(p1.x) - Quad(p0.x), dy = Quad(p1.y) - Quad(p0.y);
  const Quad ex = Quad(q1.x) - Quad(q0.x), ey = Quad(q1.y) - Quad(q0.y);
  const Quad t = ((Quad(q0.x) - Quad(p0.x)) * ey - (Quad(q0.y) - Quad(p0.y)) * ex) / (dx * ey - dy * ex);
  return {static_cast<double>(Quad(p0.x) + t * dx), static_cast<double>(Quad(p0.y) + t * dy)};
}

TEST(VectorLine, MeetsAnotherLine) {
  const auto m = vector::meeting_of({0, 0}, {4, 4}, {0, 2}, {4, -2});
  ASSERT_TRUE(m);
  EXPECT_EQ(m->at, glm::dvec2(1, 1));
  EXPECT_EQ(m->t, 0.25);
  EXPECT_EQ(m->s, 0.25);
  EXPECT_DOUBLE_EQ(m->condition, 1) << "at a right angle";
}

TEST(VectorLine, KeepsTheDigitsOfAMeetingFarAway) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    std::array<glm::dvec2, 4> p;
    for (glm::dvec2& q : p) {
      const glm::dvec3 r = test::random_row(random, 1);
      q = {1e6 + r.x, -2e6 + r.y};
    }
    const auto m = vector::meeting_of(p[0], p[1], p[2], p[3]);
    ASSERT_TRUE(m);
    const glm::dvec2 want = meeting_in_quad(p[0], p[1], p[2], p[3]);
    EXPECT_LE(std::fabs(m->at.x - want.x), test::ulp(want.x));
    EXPECT_LE(std::fabs(m->at.y - want.y), test::ulp(want.y));
  }
}

TEST(VectorLine, SaysExactlyWhatIsParallel) {
  const double third = 1.0 / 3;
  EXPECT_EQ(third * 0.75 - 1 * 0.25, 0) << "by rounded products they are parallel";
  EXPECT_TRUE(vector::meeting_of({0, 0}, {third, 1}, {0, 1}, {0.25, 1.75})) << "but a third is rounded";
  EXPECT_FALSE(vector::meeting_of({0, 0}, {1, 1}, {1e9, 0}, {1e9 + 1, 1}));
  EXPECT_TRUE(vector::meeting_of({0, 0}, {1e9, 1e9}, {0, 1}, {1e9, 1e9 + 1 + 0x1p-22})) << "one ulp off";
  EXPECT_FALSE(vector::meeting_of({1, 1}, {1, 1}, {0, 0}, {1, 0})) << "one point is no line";
  EXPECT_FALSE(vector::meeting_of({0, 0}, {NAN, 1}, {0, 0}, {1, 0}));
  EXPECT_TRUE(vector::meeting_of({0, 0}, {1e200, 1e200}, {0, 1e200}, {1e200, 0})) << "squares would overflow";
  EXPECT_TRUE(vector::meeting_of({0, 0}, {1e-200, 1e-200}, {0, 1e-200}, {1e-200, 0})) << "and underflow";
}

// ----- parametric

TEST(VectorLine, MeetsBothEndsBitForBitAndNeverTurnsBack) {
  std::mt19937_64 random(6);
  int naive_misses = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const glm::dvec3 p = test::random_row(random, 1e3), q = test::random_row(random);
    EXPECT_EQ(vector::parametric(p, q, 0), p);
    EXPECT_EQ(vector::parametric(p, q, 1), q);
    naive_misses += p + (q - p) * 1.0 != q ? 1 : 0;
  }
  EXPECT_GT(naive_misses, 100);
  const glm::dvec3 p(-1e8, 0, 0), q(1e8, 1e-3, 0);
  glm::dvec3 last = p;
  for (int i = 0; i <= 10000; ++i) {
    const glm::dvec3 at = vector::parametric(p, q, i / 10000.0);
    EXPECT_GE(at.x, last.x);
    EXPECT_GE(at.y, last.y);
    last = at;
  }
}

// ----- the node

TEST(VectorLine, TellsItsFormsAndSides) {
  const auto through = test::points({{0, 0, 0}, {4, 2, 0}}), asked = test::points({{2, 3, 0}, {2, 1, 0}});
  const auto out = test::run_node(nodes::vector_line(), {{"t", {0, 0.5}}}, {{through}, {asked}});
  EXPECT_THAT(out.at(0).as<Points>()->at, testing::ElementsAre(glm::dvec3(0), glm::dvec3(2, 1, 0)));
  EXPECT_EQ(out.at(1).as<Table>()->columns[2].numbers.at(0), 0.5);
  EXPECT_THAT(out.at(2).as<Table>()->columns[3].texts, testing::ElementsAre("left", "on"));
  EXPECT_THAT(out.at(2).as<Table>()->columns[4].texts, testing::ElementsAre("above", "on"));
}

TEST(VectorLine, TellsWhereItMeetsAnother) {
  const auto through = test::points({{0, 0, 0}, {4, 4, 0}}), across = test::points({{0, 2, 0}, {4, -2, 0}});
  const auto run = [&](test::NodeInputs in, Context& ctx) {
    return test::run_node(nodes::vector_line(), Json::object(), in, &ctx).at(3).as<Table>();
  };
  Context ctx, parallel, none;
  const auto met = run({{through}, {}, {across}}, ctx);
  ASSERT_EQ(met->columns.size(), 5u);
  EXPECT_EQ(met->columns[0].numbers, std::vector<double>{1});
  EXPECT_EQ(met->columns[2].numbers, std::vector<double>{0.25});
  EXPECT_TRUE(ctx.warnings().empty());
  for (const auto& [beside, text] : {std::pair(test::points({{0, 1, 0}, {4, 5, 0}}), "parallel"),
                                     std::pair(test::points({{1, 1, 0}, {2, 2, 0}}), "one line")}) {
    Context warned;
    EXPECT_TRUE(run({{through}, {}, {beside}}, warned)->columns[0].numbers.empty());
    ASSERT_EQ(warned.warnings().size(), 1u);
    EXPECT_EQ(warned.warnings()[0].first, "parallel_lines");
    EXPECT_THAT(warned.warnings()[0].second, testing::HasSubstr(text));
  }
  EXPECT_TRUE(run({{through}}, none)->columns[0].numbers.empty()) << "no other line, no row";
  EXPECT_TRUE(none.warnings().empty());
}

TEST(VectorLine, WarnsOfVerticalLinesAndRefusesWhatIsNone) {
  Context ctx;
  const auto out =
      test::run_node(nodes::vector_line(), Json::object(), {{test::points({{1, 0, 0}, {1, 2, 0}})}}, &ctx);
  EXPECT_EQ(out.at(1).as<Table>()->columns[1].texts.at(0), "x0") << "no m and no b";
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "vertical_line");
  for (const auto& p :
       {test::points({}), test::points({{1, 1, 1}, {1, 1, 1}}), test::points({{1, 1, 1}, {1, 1, 2}})})
    EXPECT_EQ(test::run_error(nodes::vector_line(), Json::object(), {{p}}).first, "no_line");
}

}  // namespace
}  // namespace frustum
