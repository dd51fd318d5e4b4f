#include "nodes/vector/linear.h"

#include "tests/nodes/vector/rows.h"

namespace frustum {
namespace {

using kernels::Summation;

Json cancelling(const char* sum) { return {{"weights", {{1e16, 1, -1e16}}}, {"sum", sum}}; }

TEST(VectorLinear, KeepsWhatIsLeftWhereLargeTermsCancel) {
  const auto v = test::vectors({{1, 1, 3}, {1, 2, 0.25}, {1, 1, 3}});
  const auto of = [&](const char* sum) {
    return test::run_node(nodes::vector_linear(), cancelling(sum), {{v}}).at(0).as<Vectors>()->along.at(0);
  };
  EXPECT_EQ(of("exact"), glm::dvec3(1, 2, 0.25));
  EXPECT_EQ(of("compensated"), glm::dvec3(1, 2, 0.25));
  EXPECT_NE(of("plain"), glm::dvec3(1, 2, 0.25)) << "a plain sum loses it";
}

TEST(VectorLinear, RoundsOnceWhateverCancels) {
  std::mt19937_64 random(4);
  std::uniform_int_distribution<int> exponent(-60, 60);
  double worst_compensated = 0, worst_plain = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> a;
    std::vector<glm::dvec3> v;
    test::Quad sum = 0;
    for (int i = 0; i < 8; ++i) {
      // 36 and 38 bits, so that the oracle's 113 hold every product and their sum.
      a.push_back(std::ldexp(std::round(test::random_row(random, 0x1p36).x), exponent(random) / 4));
      v.push_back(glm::dvec3(std::round(test::random_row(random, 0x1p37).x), 0, 0));
      sum += test::Quad(a[static_cast<std::size_t>(i)]) * test::Quad(v[static_cast<std::size_t>(i)].x);
    }
    // The last term takes away all but the rounding of what came before.
    a.push_back(1), v.emplace_back(-static_cast<double>(sum), 0, 0);
    sum += test::Quad(v.back().x);
    const auto error = [&](Summation how) {
      return std::fabs(static_cast<double>(kernels::linear_combination(a, v, how).x - sum)) /
             test::ulp(static_cast<double>(sum));
    };
    EXPECT_LE(error(Summation::exact), 0.5000001);
    worst_compensated = std::max(worst_compensated, error(Summation::compensated));
    worst_plain = std::max(worst_plain, error(Summation::plain));
  }
  EXPECT_GT(worst_plain, 1e12);
  EXPECT_LT(worst_compensated, worst_plain / 1e6);
}

TEST(VectorLinear, UsesTheLastVectorLast) {
  // Errata E1: as printed the last term is a_m v_1.
  const auto out = test::run_node(nodes::vector_linear(), {{"weights", {{2, 3}, {1, 0}}}},
                                  {{test::vectors({{1, 0, 0}, {0, 1, 0}})}});
  EXPECT_THAT(out.at(0).as<Vectors>()->along, testing::ElementsAre(glm::dvec3(2, 3, 0), glm::dvec3(1, 0, 0)));
}

TEST(VectorLinear, NamesTheRowOfAnotherLength) {
  const auto v = test::vectors({{1, 0, 0}});
  const auto error = test::run_error(nodes::vector_linear(), {{"weights", {{1}, {1, 2}}}}, {{v}});
  EXPECT_EQ(error.first, "rows_differ");
}

TEST(VectorLinear, IsNothingForNothing) {
  const auto out =
      test::run_node(nodes::vector_linear(), {{"weights", {Json::array()}}}, {{test::vectors({})}});
  EXPECT_EQ(out.at(0).as<Vectors>()->along.at(0), glm::dvec3(0));
}

}  // namespace
}  // namespace frustum
