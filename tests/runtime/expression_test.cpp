#include "runtime/app/suite/expression.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

double value(const std::string& text, std::vector<double> values = {}) {
  std::string problem;
  const auto e = Expression::parse(text, problem);
  EXPECT_TRUE(e) << problem;
  return e ? e->evaluate(values) : std::nan("");
}

std::string problem_of(const std::string& text) {
  std::string problem;
  EXPECT_FALSE(Expression::parse(text, problem)) << text;
  return problem;
}

TEST(Expression, BindsAsInBooks) {
  EXPECT_EQ(value("1 + 2 * 3"), 7);
  EXPECT_EQ(value("(1 + 2) * 3"), 9);
  EXPECT_EQ(value("2 ^ 3 ^ 2"), 512);
  EXPECT_EQ(value("-2 ^ 2"), -4);
  EXPECT_EQ(value("2 ^ -1"), 0.5);
  EXPECT_EQ(value("8 / 4 / 2"), 1);
  EXPECT_EQ(value("1 - 2 - 3"), -4);
  EXPECT_EQ(value("1 + 1 < 3 && 2 >= 2 || 0"), 1);
  EXPECT_EQ(value("!(1 == 1)"), 0);
  EXPECT_EQ(value("-1e-2 + .5"), 0.49);
}

TEST(Expression, CallsFunctions) {
  EXPECT_EQ(value("max(1, min(5, 3)) + abs(-2)"), 5);
  EXPECT_EQ(value("mod(-1, 4)"), 3);
  EXPECT_EQ(value("if(2 > 1, 10, 20)"), 10);
  EXPECT_DOUBLE_EQ(value("cos(pi)"), -1);
}

TEST(Expression, KnowsItsNamesInOrder) {
  std::string problem;
  const auto e = Expression::parse("N.x^2 + uv.u * N.x", problem);
  ASSERT_TRUE(e) << problem;
  EXPECT_THAT(e->names(), testing::ElementsAre("N.x", "uv.u"));
  EXPECT_EQ(e->evaluate(std::vector<double>{3, 2}), 15);
}

TEST(Expression, HidesNoNan) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const char* text :
       {"a < 1", "max(a, 1)", "min(1, a)", "a && 0", "0 || a", "!a", "a == a", "if(a, 1, 2)", "a ^ 0"})
    EXPECT_TRUE(std::isnan(value(text, {nan}))) << text;
}

TEST(Expression, SaysWhereItIsWrong) {
  EXPECT_THAT(problem_of("1 +"),
              testing::HasSubstr("ends where a number or a name is expected at character 4"));
  EXPECT_THAT(problem_of("(1"), testing::HasSubstr("expected ')'"));
  EXPECT_THAT(problem_of("1 2"), testing::HasSubstr("'2' is not expected at character 3"));
  EXPECT_THAT(problem_of("sine(1)"), testing::HasSubstr("no function 'sine' at character 1"));
  EXPECT_THAT(problem_of("min(1)"), testing::HasSubstr("expected ','"));
  EXPECT_THAT(problem_of("1e999"), testing::HasSubstr("expected a number"));
  problem_of(""), problem_of(std::string(5000, '('));
}

}  // namespace
}  // namespace frustum
