// How cases are run: goldens, retries, waivers, diagnostics, reports.
#include "tests/support/suite_runs.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace frustum {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// ----- goldens

const std::string golden =
    R"({"id": "t", "graph": "image.json", "checks": [{"port": "out", "golden": true}]})";
const std::string with_max =
    R"({"id": "t", "graph": "image.json", "checks": [{"port": "out", "golden": true, "max": 0.01,
      "why": "a test"}]})";

TEST(SuiteGolden, IsAcceptedAndThenHeld) {
  const test::SuiteFolder folder;
  EXPECT_THAT(folder.run(golden).at(0).failures,
              ElementsAre(HasSubstr("nothing was accepted yet; frustum test")));
  const auto accepted = folder.accept(golden, "the first").at(0);
  EXPECT_EQ(accepted.verdict, CaseVerdict::pass);
  ASSERT_THAT(accepted.accepted, SizeIs(1));
  EXPECT_EQ(accepted.accepted[0].change, "new");
  EXPECT_EQ(folder.run(golden).at(0).verdict, CaseVerdict::pass);
  const Json book = Json::parse(content(folder.files().file("golden/s.json")));
  EXPECT_EQ(book["entries"]["t out"]["reason"], "the first");
  EXPECT_EQ(book["entries"]["t out"]["digest"], accepted.accepted[0].digest);
  EXPECT_NE(book["entries"]["t out"]["version"], "");
}

TEST(SuiteGolden, ThatDiffersFailsBeyondItsTolerance) {
  const test::SuiteFolder folder;
  folder.accept(with_max);
  folder.graph("image.json", "test.image", R"({"add": 0.005})");
  EXPECT_EQ(folder.run(with_max).at(0).verdict, CaseVerdict::pass);
  EXPECT_THAT(folder.run(golden).at(0).failures, Contains(HasSubstr("is not the accepted")));
  folder.graph("image.json", "test.image", R"({"add": 0.02})");
  EXPECT_THAT(folder.run(with_max).at(0).failures, Contains(HasSubstr("against the accepted one: max 0.02")));
}

TEST(SuiteGolden, OfAMeshKeepsItsNumbersWhereATolerancesNeedsThem) {
  const test::SuiteFolder folder;
  const std::string mesh =
      R"({"id": "m", "graph": "mesh.json", "checks": [{"port": "out", "golden": true, "max": 0.1,
      "why": "a test"}]})";
  folder.accept(mesh);
  folder.graph("mesh.json", "test.mesh", R"({"scale": 1.05})");
  EXPECT_EQ(folder.run(mesh).at(0).verdict, CaseVerdict::pass);
  folder.graph("mesh.json", "test.mesh", R"({"scale": 1.2})");
  EXPECT_THAT(folder.run(mesh).at(0).failures, Contains(HasSubstr("max 0.2")));
}

TEST(SuiteGolden, ThatIsNotFiniteIsRefused) {
  const test::SuiteFolder folder;
  folder.graph("image.json", "test.image", R"({"nan": true})");
  const auto r = folder.accept(golden).at(0);
  EXPECT_THAT(r.accepted, IsEmpty());
  EXPECT_THAT(r.failures, Contains(HasSubstr("not accepted, since it is not finite")));
  EXPECT_FALSE(std::filesystem::exists(folder.files().file("golden/s.json")));
}

TEST(SuiteGolden, IsShownWithItsChangeAndNothingIsRecordedInAReview) {
  const test::SuiteFolder folder;
  folder.accept(golden);
  const std::string before = content(folder.files().file("golden/s.json"));
  folder.graph("image.json", "test.image", R"({"add": 0.25})");
  SuiteOptions review;
  review.isolate = false, review.goldens = Goldens::propose;
  const auto r = folder.run(golden, review).at(0);
  ASSERT_THAT(r.accepted, SizeIs(1));
  EXPECT_THAT(r.accepted[0].change, HasSubstr("rmse 0.25, max 0.25"));
  EXPECT_EQ(content(folder.files().file("golden/s.json")), before);
}

TEST(SuiteGolden, ReplacedLeavesNoFileBehind) {
  const test::SuiteFolder folder;
  folder.accept(golden);
  folder.graph("image.json", "test.image", R"({"add": 0.25})");
  folder.accept(golden);
  int pictures = 0;
  for (const auto& e : std::filesystem::directory_iterator(folder.files().file("golden")))
    pictures += e.path().extension() == ".exr" ? 1 : 0;
  EXPECT_EQ(pictures, 1);
}

TEST(SuiteGolden, WithATraceNamesTheFirstPortThatDiffers) {
  const test::SuiteFolder folder;
  const auto chain = [&](const char* add) {
    folder.files().write("suites/chain.json", R"({"format": "frustum.graph/1", "nodes": {
      "last":  {"type": "test.copy", "in": {"image": "first"}},
      "first": {"type": "test.image", "params": {"add": )" +
                                                  std::string(add) +
                                                  R"(}}}, "outputs": {"out": {"from": "last"}}})");
  };
  const std::string traced =
      R"({"id": "t", "graph": "chain.json", "checks": [{"port": "out", "golden": true, "trace": true}]})";
  chain("0");
  folder.accept(traced);
  EXPECT_EQ(folder.run(traced).at(0).verdict, CaseVerdict::pass);
  chain("0.5");
  EXPECT_THAT(folder.run(traced).at(0).failures,
              Contains("the first port that is not what was accepted: first.image"));
}

// ----- diagnostics

TEST(SuiteRun, ExpectsDiagnosticsExactly) {
  const test::SuiteFolder folder;
  folder.files().write("suites/bad.json",
                       R"({"format": "frustum.graph/1", "nodes": {"a": {"type": "test.imgae"}}})");
  const auto r = folder.run(
      R"({"id": "right", "graph": "bad.json", "expect": {"code": "unknown_type",
      "pointer": "/nodes/a/type", "line": 1, "suggestion": "test.image"}},
         {"id": "wrong", "graph": "bad.json", "expect": [{"code": "cycle"}]},
         {"id": "good", "graph": "image.json", "expect": {"code": "cycle"}},
         {"id": "none", "graph": "bad.json"},
         {"id": "file", "graph": "none.json"},
         {"id": "expected", "graph": "none.json", "expect": {"code": "missing_file", "pointer": "/cases/5/graph"}},
         {"id": "port", "graph": "image.json", "checks": [{"port": "oout"}]})");
  EXPECT_THAT(r[0].failures, IsEmpty());
  EXPECT_THAT(r[1].failures, ElementsAre(HasSubstr("expected the diagnostic cycle"),
                                         HasSubstr("not expected: unknown_type")));
  EXPECT_EQ(r[2].verdict, CaseVerdict::fail);
  EXPECT_EQ(r[3].verdict, CaseVerdict::fail);
  EXPECT_EQ(r[4].verdict, CaseVerdict::fail) << "the suite is wrong, and nothing broke";
  EXPECT_THAT(r[4].failures, ElementsAre(AllOf(HasSubstr("not expected: missing_file at "),
                                               HasSubstr(" /cases/4/graph: "), HasSubstr("none.json"))));
  EXPECT_THAT(r[5].failures, IsEmpty());
  EXPECT_THAT(r[6].failures, ElementsAre(HasSubstr("did you mean 'out'?")));
}

// ----- retries, waivers, skips

TEST(SuiteRun, CallsAFailureThatPassesLaterFlaky) {
  const test::SuiteFolder folder;
  const auto flaky = [&](const std::string& more) {
    std::filesystem::remove(folder.files().file("here"));
    folder.graph("flaky.json", "test.act",
                 R"({"what": "flaky", "file": ")" + folder.files().file("here") + "\"}");
    return folder.run(R"({"id": "f", "graph": "flaky.json")" + more + "}").at(0);
  };
  EXPECT_EQ(flaky("").verdict, CaseVerdict::fail);
  const CaseResult r = flaky(R"(, "retry": 2)");
  EXPECT_EQ(r.verdict, CaseVerdict::flaky);
  EXPECT_EQ(r.attempts, 2);
  EXPECT_THAT(r.notes, ElementsAre(HasSubstr("attempt 1, fail: ")));
  EXPECT_FALSE(counts_against(r.verdict));
}

TEST(SuiteRun, WaivesUntilTheDateHasPassed) {
  const test::SuiteFolder folder;
  const auto on = [&](const char* day, const char* graph) {
    SuiteOptions options;
    options.isolate = false, options.today = day;
    return folder
        .run(R"({"id": "w", "graph": ")" + std::string(graph) +
                 R"(.json", "waiver": {"until": "2030-06-30", "why": "known"}, "checks": [{"port": "out",
      "shape": {"width": 8}}]})",
             options)
        .at(0);
  };
  EXPECT_EQ(on("2030-06-30", "act").verdict, CaseVerdict::waived);
  EXPECT_EQ(on("2030-07-01", "act").verdict, CaseVerdict::fail);
  EXPECT_EQ(on("2030-06-30", "image").verdict, CaseVerdict::pass);
  EXPECT_THAT(on("2030-06-30", "image").notes, ElementsAre(HasSubstr("is not needed")));
  EXPECT_EQ(on("2030-07-01", "image").verdict, CaseVerdict::fail) << "it is in the way once it has expired";
}

TEST(SuiteRun, SkipsAndSaysWhy) {
  const test::SuiteFolder folder;
  const auto r =
      folder.run(R"({"id": "s", "graph": "none.json", "skip": "needs a file that is not there"})").at(0);
  EXPECT_EQ(r.verdict, CaseVerdict::skip);
  EXPECT_THAT(r.notes, ElementsAre("skipped: needs a file that is not there"));
}

TEST(SuiteRun, ReadsOnlyWhatIsChosen) {
  const test::SuiteFolder folder;
  const std::string cases =
      R"({"id": "one", "graph": "image.json", "tags": ["slow"]}, {"id": "two", "graph": "image.json"})";
  SuiteOptions options;
  options.isolate = false, options.filters = {"slow"};
  EXPECT_EQ(folder.run(cases, options).at(0).id, "one");
  options.filters = {"three"};
  EXPECT_TRUE(folder.run(cases, options).empty());
}

// The parts of a suite that several machines run: all of it, and nothing twice.
TEST(SuiteRun, ShardsAreTheWholeAndDisjoint) {
  const test::SuiteFolder folder;
  const std::string cases =
      R"({"id": "b", "graph": "image.json", "matrix": {"made:add": [0, 1, 2, 3, 4, 5, 6, 7, 8, 9]}},
      {"id": "m", "graph": "mesh.json", "matrix": {"made:scale": [1, 2, 3, 4]}})";
  const auto ids = [&](std::optional<Shard> shard) {
    SuiteOptions options;
    options.isolate = false, options.shard = shard.value_or(Shard{});
    std::vector<std::string> out;
    for (const CaseResult& r : folder.run(cases, options)) out.push_back(r.id);
    return out;
  };
  const auto whole = ids(std::nullopt);
  ASSERT_THAT(whole, SizeIs(14));
  for (const int count : {1, 2, 3, 20}) {
    std::vector<std::string> together;
    for (int i = 1; i <= count; ++i)
      for (std::string& id : ids(Shard{i, count})) together.push_back(std::move(id));
    EXPECT_THAT(together, testing::UnorderedElementsAreArray(whole)) << count;
  }
}

// ----- reports

TEST(SuiteReport, IsTheSameAfterItLeftItsProcess) {
  const test::SuiteFolder folder;
  CaseResult r = folder.run(golden).at(0);
  r.said = "said", r.tags = {"a"}, r.notes = {"n"}, r.pictures = {{"p", "q", "o", "r", "srgb"}};
  EXPECT_EQ(case_to_json(case_from_json(case_to_json(r))).dump(), case_to_json(r).dump());
}

TEST(SuiteReport, EscapesXml) {
  CaseResult r;
  r.suite = "s", r.id = "a<b>&\"c\"", r.verdict = CaseVerdict::fail, r.failures = {"1 < 2\x01"};
  const std::string text = junit_text({r});
  EXPECT_THAT(text, HasSubstr("name=\"a&lt;b&gt;&amp;&quot;c&quot;\""));
  EXPECT_THAT(text, HasSubstr("message=\"1 &lt; 2?\""));
  EXPECT_THAT(text, HasSubstr("tests=\"1\" failures=\"1\" errors=\"0\" skipped=\"0\""));
}

TEST(SuiteReport, CountsEveryVerdict) {
  std::vector<CaseResult> all(verdicts);
  for (int i = 0; i < verdicts; ++i) all[static_cast<std::size_t>(i)].verdict = static_cast<CaseVerdict>(i);
  const Json j = to_json(all);
  for (int i = 0; i < verdicts; ++i) EXPECT_EQ(j[std::string(name_of(static_cast<CaseVerdict>(i)))], 1);
  EXPECT_EQ(summary_text(all), "1 of 7 cases pass, 1 fail, 1 skip, 1 timeout, 1 crash, 1 waived, 1 flaky\n");
  EXPECT_THAT(junit_text(all), HasSubstr("tests=\"7\" failures=\"1\" errors=\"2\" skipped=\"2\""));
}

}  // namespace
}  // namespace frustum
