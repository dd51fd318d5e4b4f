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
