// `frustum stability` as a user meets it, and what becomes of cases that do not hold.
#include "runtime/app/stability/docs.h"
#include "runtime/app/stability/report.h"
#include "tests/support/process.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace frustum::stability {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Stability, PrintsBothErrorsTheBoundAndThePrice) {
  const auto r = test::frustum({"stability", "--filter", "fnd-07", "--json"});
  ASSERT_EQ(r.code, 0) << r.err;
  const auto all = nlohmann::json::parse(r.out);
  ASSERT_EQ(all["cases"].size(), 1u);
  const auto& c = all["cases"][0];
  EXPECT_EQ(c["id"], "FND-07");
  EXPECT_EQ(c["state"], "holds");
  EXPECT_EQ(c["naive"]["error"], 11972);  // of 65536 points: the published number
  EXPECT_THAT(c["naive"]["witness"].get<std::string>(), HasSubstr("0x1p-1"));
  EXPECT_EQ(c["robust"]["error"], 0);
  EXPECT_GT(c["price"]["ratio"], 0);
  EXPECT_THAT(test::frustum({"stability", "--filter", "classroom"}).out, HasSubstr("FND-07  holds"));
}

TEST(Stability, AFilterThatMatchesNothingIsAMistake) {
  const auto r = test::frustum({"stability", "--filter", "no such case"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("no hard case matches"));
}

// Catalogues of one case, whose methods err as told.
constexpr CatalogueRow row[] = {{"AAA-01", "A stage", "a title", true}};
template <int naive, int robust>
void errs(Trial& t) {
  t.measure(naive, robust, {0.1});
}
HardCases one(void (*run)(Trial&), std::vector<ArguedCase> argued = {}) {
  return {row, {{"AAA-01", "in", "plain", "ours", "truth", "small", "ulp", 2, run}}, std::move(argued), {}};
}
Outcome judged(const HardCases& all) { return run_case(all, all.catalogue[0], {}); }

TEST(Stability, HoldsOnlyWhereTheNaiveMethodFailsAndOursDoesNot) {
  EXPECT_EQ(judged(one(errs<3, 2>)).state, State::holds);
  EXPECT_EQ(judged(one(errs<2, 1>)).state, State::naive_survives);
  const Outcome broken = judged(one(errs<9, 3>));
  EXPECT_EQ(broken.state, State::broken);
  EXPECT_THAT(broken.why, HasSubstr("error 3 above 2 ulp at (0x1.999999999999ap-4)"));
  EXPECT_EQ(judged(one([](Trial&) {})).state, State::broken) << "nothing was measured";
  EXPECT_EQ(judged(one([](Trial& t) { t.measure(9, std::numeric_limits<double>::quiet_NaN(), {1}); })).state,
            State::broken)
      << "NaN is no small error";
  const Outcome required = judged(one([](Trial& t) {
    t.measure(9, 0, {1});
    t.require(true, "never said");
    t.require(false, "ends meet", {2});
  }));
  EXPECT_EQ(required.state, State::broken);
  EXPECT_EQ(required.why, "ends meet at (0x1p+1)");
  EXPECT_EQ(judged(one(errs<9, 3>, {{"AAA-01", "because"}})).state, State::argued);
  EXPECT_EQ(run_case({row, {}, {}, {}}, row[0], {}).state, State::not_built);
}

TEST(Stability, ThePageSaysWhatDoesNotHold) {
  const auto page = [](const HardCases& all) { return stability_page(all, run_cases(all, {})); };
  EXPECT_THAT(page(one(errs<9, 1>)),
              HasSubstr("| AAA-01 | **a title**: in | plain | 9 | ours | 1 | 2 ulp |"));
  EXPECT_THAT(page(one(errs<9, 1>)), Not(HasSubstr("do not hold.")));
  EXPECT_THAT(page(one(errs<9, 3>)), HasSubstr("**1 do not hold.**"));
}

TEST(Stability, PricesAreRatiosOfTheSameWork) {
  Trial t("AAA-01", false, true);
  const auto work = [](int n) {
    return [n] {
      double sum = 0;
      for (int i = 0; i < n; ++i) keep(sum += i);
    };
  };
  t.price(work(1000), work(4000));
  ASSERT_TRUE(t.paid);
  EXPECT_GT(t.paid->ratio, 1.5);
  EXPECT_GT(t.paid->robust_ns, t.paid->naive_ns);
}

}  // namespace
}  // namespace frustum::stability
