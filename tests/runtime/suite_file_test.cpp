#include "runtime/app/suite/suite.h"

#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

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

}  // namespace
}  // namespace frustum
