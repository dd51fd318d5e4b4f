// tests/bad_suites/NAME.json must give exactly the diagnostics of NAME.expected.json: none missing, none
// more, none different.  After a change of wording, FRUSTUM_ACCEPT=1 in the environment writes the files
// anew; the difference is then for whoever commits it to judge.
#include "runtime/app/files.h"
#include "runtime/app/suite/suite.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>

namespace frustum {
namespace {

namespace fs = std::filesystem;

const fs::path& root() {
  static const fs::path path = FRUSTUM_SOURCE_DIR;
  return path;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(root() / "tests/bad_suites")) {
    const std::string file = entry.path().filename().string();
    if (file.find(".expected.") == std::string::npos) out.push_back(entry.path().stem().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

// The diagnostics of a file, named as in the repository.
Json diagnostics_of(const std::string& name, bool& loaded) {
  Diagnostics problems;
  loaded = load_suite((root() / "tests/bad_suites" / (name + ".json")).string(), problems).has_value();
  for (Diagnostic& d : problems.list()) d.file = name + ".json";
  return to_json(problems);
}

class BadSuite : public testing::TestWithParam<std::string> {};

TEST_P(BadSuite, GivesExactlyItsDiagnostics) {
  const fs::path expected = root() / "tests/bad_suites" / (GetParam() + ".expected.json");
  bool loaded = false;
  const Json found = diagnostics_of(GetParam(), loaded);
  EXPECT_FALSE(loaded);
  if (std::getenv("FRUSTUM_ACCEPT") != nullptr)
    write_text(expected, found.dump(2) + "\n");  // NOLINT(concurrency-mt-unsafe)
  EXPECT_EQ(found, Json::parse(read_text(expected))) << found.dump(2);
  for (const Json& d : found["diagnostics"]) EXPECT_GT(d["line"].get<int>(), 0) << d;
}

INSTANTIATE_TEST_SUITE_P(BadSuites, BadSuite, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

TEST(BadSuites, AreManyAndShowEveryCodeOfTheReader) {
  EXPECT_GE(names().size(), 20u);
  std::set<std::string> shown, codes;
  for (const std::string& name : names()) {
    bool loaded = false;
    const Json found = diagnostics_of(name, loaded);
    for (const Json& d : found["diagnostics"]) shown.insert(d["code"]);
  }
  const std::regex pattern(R"re(\bproblem\(\s*"([a-z_]+)")re");
  for (const auto& entry : fs::directory_iterator(root() / "runtime/app/suite")) {
    if (!entry.path().filename().string().starts_with("read")) continue;
    const std::string text = read_text(entry.path());
    for (std::sregex_iterator m(text.begin(), text.end(), pattern), end; m != end; ++m) codes.insert((*m)[1]);
  }
  const std::string pages = read_text(root() / "docs/diagnostics.md");
  EXPECT_GT(codes.size(), 8u);
  for (const std::string& code : codes) {
    EXPECT_TRUE(shown.contains(code)) << code << " has no file in tests/bad_suites";
    EXPECT_NE(pages.find("\n### " + code + "\n"), std::string::npos)
        << code << " has no section in docs/diagnostics.md";
  }
}

}  // namespace
}  // namespace frustum
