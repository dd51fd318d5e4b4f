#include "runtime/app/suite.h"

#include "runtime/app/suite_run.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string suite_with(const std::string& cases, const std::string& presets = "{}") {
  return R"({"format": "frustum.suite/1", "presets": )" + presets + R"(, "cases": [)" + cases + "]}";
}

struct Read {
  std::optional<Suite> suite;
  Diagnostics problems;
};

Read read(const std::string& text, const test::TempFolder& folder) {
  Read r;
  r.suite = load_suite(folder.write("s.json", text), r.problems);
  return r;
}

std::vector<std::string> ids(const Suite& s) {
  std::vector<std::string> out;
  for (const SuiteCase& c : s.cases) out.push_back(c.id);
  return out;
}

TEST(SuiteFile, RunsEveryCombinationOfAMatrix) {
  const test::TempFolder folder;
  const auto r = read(
      suite_with(
          R"({"id": "t", "graph": "g.json", "matrix": {"samples": [1, 4], "lit:mode": ["flat", "phong"]}})"),
      folder);
  ASSERT_TRUE(r.suite) << to_text(r.problems);
  EXPECT_THAT(ids(*r.suite), ElementsAre("t[lit:mode=flat,samples=1]", "t[lit:mode=flat,samples=4]",
                                         "t[lit:mode=phong,samples=1]", "t[lit:mode=phong,samples=4]"));
  EXPECT_EQ(r.suite->cases[0].settings[0].value, "\"flat\"");
  EXPECT_EQ(r.suite->cases[0].graph, folder.file("g.json"));
}

TEST(SuiteFile, ACaseStandsAboveItsPresets) {
  const test::TempFolder folder;
  const auto r =
      read(suite_with(R"({"id": "t", "graph": "g.json", "use": ["a", "b"], "set": {"x": 3}})",
                      R"({"a": {"set": {"x": 1, "y": 1}}, "b": {"set": {"y": 2}, "matrix": {"x": [7, 8]}}})"),
           folder);
  ASSERT_TRUE(r.suite) << to_text(r.problems);
  ASSERT_EQ(r.suite->cases.size(), 1u);
  std::map<std::string, std::string> set;
  for (const Setting& s : r.suite->cases[0].settings) set[s.address] = s.value;
  EXPECT_EQ(set, (std::map<std::string, std::string>{{"x", "3"}, {"y", "2"}}));
}

TEST(SuiteFile, APatternMakesOneCaseOfEveryFile) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder.file("g/a"));
  std::filesystem::create_directories(folder.file("g/b"));
  folder.write("g/b/two.json", "{}"), folder.write("g/a/one.json", "{}"), folder.write("g/a/note.txt", "");
  const auto r = read(suite_with(R"({"id": "all", "graph": "g/*/*.json"})"), folder);
  ASSERT_TRUE(r.suite) << to_text(r.problems);
  EXPECT_THAT(ids(*r.suite), ElementsAre("all/a/one", "all/b/two"));
}

TEST(SuiteFile, NamesEveryProblemAtItsPlace) {
  const test::TempFolder folder;
  const auto r = read(R"({"format": "frustum.suite/1",
  "cases": [
    {"id": "a", "grahp": "x.json"},
    {"id": "a", "graph": "x.json", "use": ["smal"], "checks": [{"port": "p", "rmse": 0.1, "golden": true}]},
    {"id": "c", "graph": "none/*.json", "checks": [{"port": "p", "max": -1, "golden": true}, {"max": 0}]}],
  "presets": {"small": {}}})",
                      folder);
  EXPECT_FALSE(r.suite);
  std::vector<std::string> seen;
  for (const Diagnostic& d : r.problems.list())
    seen.push_back(d.code + " " + d.pointer + ":" + std::to_string(d.line));
  EXPECT_THAT(seen, Contains("unknown_key /cases/0/grahp:3"));
  EXPECT_THAT(seen, Contains("missing_key /cases/0:3"));
  EXPECT_THAT(seen, Contains("duplicate_id /cases/1/id:4"));
  EXPECT_THAT(seen, Contains("unknown_preset /cases/1/use/0:4"));
  EXPECT_THAT(seen, Contains("missing_key /cases/1/checks/0:4")) << "a tolerance above zero needs a why";
  EXPECT_THAT(seen, Contains("no_match /cases/2/graph:5"));
  EXPECT_THAT(seen, Contains("out_of_range /cases/2/checks/0/max:5"));
  EXPECT_THAT(to_text(r.problems), HasSubstr("did you mean 'graph'?"));
}

TEST(SuiteFile, ThatIsNoJsonIsOneProblem) {
  const test::TempFolder folder;
  EXPECT_EQ(read("{", folder).problems.list().at(0).code, "not_json");
}

// ----- running: a graph that needs nothing but numbers, so that what is judged is the judge

std::vector<CaseResult> run(const std::string& cases, const test::TempFolder& folder,
                            SuiteOptions options = {}) {
  std::filesystem::create_directories(folder.file("suites"));
  folder.write("suites/teapot.json",
               R"({"format": "frustum.graph/1",
    "nodes": {"teapot": {"type": "io.load_patches", "params": {"file": ")" +
                   std::string(FRUSTUM_SOURCE_DIR) +
                   R"(/graphs/data/teapot.json"}}}, "outputs": {"patches": {"from": "teapot"}}})");
  Diagnostics problems;
  const auto suite = load_suite(folder.write("suites/s.json", suite_with(cases)), problems);
  if (!suite) throw std::runtime_error(to_text(problems));
  Session session;
  return run_suite(session, *suite, options, [](const CaseResult&) {});
}

TEST(SuiteRun, PassesWhatHolds) {
  const test::TempFolder folder;
  const auto r = run(R"({"id": "t", "graph": "teapot.json"})", folder);
  ASSERT_EQ(r.size(), 1u);
  EXPECT_EQ(r[0].verdict, Verdict::pass) << testing::PrintToString(r[0].failures);
  EXPECT_EQ(r[0].checks, 1) << "finite";
}

TEST(SuiteRun, FailsWhatDoesNotHold) {
  const test::TempFolder folder;
  const auto r = run(
      R"({"id": "shape", "graph": "teapot.json", "checks": [{"port": "patches", "shape": {"patches": 31, "wings": 2}}]},
                        {"id": "port", "graph": "teapot.json", "checks": [{"port": "teapto", "shape": {}}]},
                        {"id": "probe", "graph": "teapot.json", "checks": [{"port": "patches", "probe": {"pixel": [0, 0], "equals": 0}}]},
                        {"id": "file", "graph": "none.json"})",
      folder);
  ASSERT_EQ(r.size(), 4u);
  EXPECT_THAT(r[0].failures, ElementsAre(HasSubstr("patches is 32, expected 31"), HasSubstr("no 'wings'")));
  EXPECT_THAT(r[1].failures, ElementsAre(HasSubstr("teapto")));
  EXPECT_THAT(r[2].failures, ElementsAre(HasSubstr("needs pixels")));
  EXPECT_EQ(r[3].verdict, Verdict::crash) << "the world failed";
}

TEST(SuiteRun, ExpectsDiagnosticsExactly) {
  const test::TempFolder folder;
  std::filesystem::create_directories(folder.file("suites"));
  folder.write("suites/bad.json",
               R"({"format": "frustum.graph/1", "nodes": {"a": {"type": "io.load_patchse"}}})");
  const auto r = run(
      R"({"id": "right", "graph": "bad.json", "expect": {"code": "unknown_type", "pointer": "/nodes/a/type", "line": 1,
                          "suggestion": "io.load_patches"}},
                        {"id": "wrong", "graph": "bad.json", "expect": {"code": "cycle"}},
                        {"id": "good", "graph": "teapot.json", "expect": {"code": "cycle"}},
                        {"id": "none", "graph": "bad.json"})",
      folder);
  ASSERT_EQ(r.size(), 4u);
  EXPECT_THAT(r[0].failures, IsEmpty());
  EXPECT_THAT(r[1].failures, ElementsAre(HasSubstr("expected the diagnostic cycle"),
                                         HasSubstr("not expected: unknown_type")));
  EXPECT_EQ(r[2].verdict, Verdict::fail);
  EXPECT_EQ(r[3].verdict, Verdict::fail);
}

TEST(SuiteRun, GoldensAreAcceptedAndThenHeld) {
  const test::TempFolder folder;
  const std::string cases =
      R"({"id": "t", "graph": "teapot.json", "checks": [{"port": "patches", "golden": true}]})";
  EXPECT_THAT(run(cases, folder).at(0).failures, ElementsAre(HasSubstr("nothing was accepted yet")));
  SuiteOptions accept;
  accept.accept = true, accept.reason = "first";
  const auto accepted = run(cases, folder, accept).at(0);
  EXPECT_THAT(accepted.accepted, ElementsAre(HasSubstr("new")));
  EXPECT_EQ(accepted.verdict, Verdict::pass);
  EXPECT_EQ(run(cases, folder).at(0).verdict, Verdict::pass);

  const std::string book = folder.file("golden/s.json");
  std::ifstream in(book);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  EXPECT_THAT(text, HasSubstr("\"reason\": \"first\""));
  const auto digest = Json::parse(text)["entries"]["t patches"]["digest"].get<std::string>();
  text.replace(text.find(digest), 4, digest.starts_with("0000") ? "1111" : "0000");
  folder.write("golden/s.json", text);
  EXPECT_THAT(run(cases, folder).at(0).failures, ElementsAre(HasSubstr("is not the accepted 0000")));
}

TEST(SuiteRun, FiltersByIdAndTag) {
  const test::TempFolder folder;
  const std::string cases =
      R"({"id": "one", "graph": "teapot.json", "tags": ["slow"]}, {"id": "two", "graph": "teapot.json"})";
  SuiteOptions options;
  options.filters = {"slow"};
  EXPECT_EQ(run(cases, folder, options).at(0).id, "one");
  options.filters = {"tw"};
  EXPECT_EQ(run(cases, folder, options).at(0).id, "two");
  options.filters = {"three"};
  EXPECT_TRUE(run(cases, folder, options).empty());
}

TEST(SuiteReport, EscapesXml) {
  CaseResult r;
  r.suite = "s", r.id = "a<b>&\"c\"", r.verdict = Verdict::fail, r.failures = {"1 < 2\x01"};
  const std::string text = junit_text({r});
  EXPECT_THAT(text, HasSubstr("name=\"a&lt;b&gt;&amp;&quot;c&quot;\""));
  EXPECT_THAT(text, HasSubstr("message=\"1 &lt; 2?\""));
  EXPECT_THAT(text, HasSubstr("tests=\"1\" failures=\"1\" errors=\"0\""));
}

}  // namespace
}  // namespace frustum
