// What the README says of its pictures and shows as commands holds.

#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace frustum {
namespace {

const std::string root = FRUSTUM_SOURCE_DIR;

std::string readme() {
  std::ostringstream text;
  text << std::ifstream(root + "/README.md").rdbuf();
  return text.str();
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

TEST(Readme, TheFlatTeapotIsMadeAsItsCaptionSays) {
  const std::string text = readme();
  const std::regex caption("`((?:--set [^ `]+ ?)+)`: flat shading");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(text, found, caption));
  const test::TempFolder folder;
  std::vector<std::string> run{"run", root + "/graphs/gallery/teapot.json", "--out", folder.path()};
  for (const std::string& word : words(found[1])) run.push_back(word);
  const auto made = test::frustum(run);
  ASSERT_EQ(made.code, 0) << made.err;
  const auto same = test::frustum(
      {"diff", folder.file("teapot.png"), root + "/docs/images/teapot_flat.png", "--metric", "rmse=0.002"});
  EXPECT_EQ(same.code, 0) << same.out;
}

// The fenced block of commands under "## A graph": each begins with the program's name; what stands after three
// blanks is a remark, and a line that begins with blanks goes on with one.
std::vector<std::string> commands() {
  std::vector<std::string> out;
  std::istringstream lines(readme());
  bool fenced = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("```")) fenced = !fenced;
    if (fenced && line.starts_with("frustum ")) out.push_back(line.substr(0, line.find("   ", 17)));
  }
  return out;
}

TEST(Readme, ItsCommandsRun) {
  const auto all = commands();
  ASSERT_GE(all.size(), 8u);
  const test::TempFolder folder;
  for (const std::string& command : all) {
    std::vector<std::string> arguments = words(command);
    arguments.erase(arguments.begin());
    for (std::string& a : arguments)
      if (a.starts_with("graphs/") || a.starts_with("tests/")) a = root + "/" + a;
    // The words are what is tried, on less than all: suites and hard cases have tests of their own.
    if (arguments[0] == "run" || arguments[0] == "report")
      arguments.insert(arguments.end(), {"--set", "resolution=[160,90]"});
    if (arguments[0] == "test") arguments.insert(arguments.end(), {"--filter", "stages*"});
    if (arguments[0] == "stability") arguments.back() = "CLP-01";
    const auto result = test::frustum(arguments, folder.path());
    EXPECT_EQ(result.code, 0) << command << "\n" << result.out << result.err;
  }
}

}  // namespace
}  // namespace frustum
