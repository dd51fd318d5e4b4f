#include "runtime/app/scaffold.h"

#include "runtime/core/diagnostic.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace frustum {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(NewNode, NamesAreFamilyDotNodeInSnakeCase) {
  for (const char* good : {"curve.supercircle", "io.load_mesh2"})
    EXPECT_EQ(problem_of_node_name(good), "") << good;
  for (const char* bad : {"", "curve", "Curve.arc", "curve.Arc", "curve.arc.x", "curve.", ".arc",
                          "curve.1arc", "cur-ve.arc", "../x.y", "kernels.sum", "class.a", "a.class",
                          "new.delete", "std.vector", "node.node", "curve_a.b", "curve.a__b", "curve.a_"})
    EXPECT_NE(problem_of_node_name(bad), "") << bad;
}

// The words of a command as a shell would see them: quotes and backslashes keep spaces inside a word.
std::vector<std::string> shell_words(const std::string& command) {
  std::vector<std::string> words;
  bool inside = false, quoted = false;
  for (std::size_t i = 0; i < command.size(); ++i) {
    const char c = command[i];
    if (c == ' ' && !quoted) {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    if (c == '"')
      quoted = !quoted;
    else if (c == '\\' && i + 1 < command.size())
      words.back() += command[++i];
    else
      words.back() += c;
  }
  return words;
}

// How this build compiles a file of nodes/, without the output: from compile_commands.json.
std::vector<std::string> compile_command() {
  const fs::path build = fs::path(test::frustum_program()).parent_path().parent_path();
  std::ifstream in(build / "compile_commands.json");
  for (const Json& entry : Json::parse(in)) {
    if (!entry["file"].get<std::string>().ends_with("nodes/io/load_patches.cpp")) continue;
    std::vector<std::string> command;
    const std::vector<std::string> words = shell_words(entry["command"].get<std::string>());
    for (std::size_t i = 0; i < words.size(); ++i) {
      if (words[i] == "-o" || words[i] == "-c")
        ++i;
      else if (!words[i].ends_with("ccache"))
        command.push_back(words[i]);
    }
    return command;
  }
  return {};
}

// What the page shows as written by the command is what the command writes.
TEST(NewNode, ThePageShowsItsSource) {
  std::ostringstream read;
  read << std::ifstream(std::string(FRUSTUM_SOURCE_DIR) + "/docs/adding_a_node.md").rdbuf();
  const std::string page = read.str();
  const std::size_t begin = page.find("\n## The declaration\n"), end = page.find("\n## ", begin + 1);
  ASSERT_LT(begin, end);
  ASSERT_NE(end, std::string::npos);
  const auto files = scaffold("curve.arc", NewNode::geometry);
  const auto source =
      std::find_if(files.begin(), files.end(), [](const auto& f) { return f.path.ends_with("arc.cpp"); });
  ASSERT_NE(source, files.end());
  const std::string open = "```cpp\n", close = "```\n";
  int blocks = 0;
  for (std::size_t at = begin; (at = page.find(open, at)) < end; ++blocks) {
    at += open.size();
    EXPECT_THAT(source->text, HasSubstr(page.substr(at, page.find(close, at) - at)));
  }
  EXPECT_EQ(blocks, 2);
  for (const ScaffoldFile& f : files) EXPECT_THAT(page, HasSubstr("`" + f.path + "`"));
}

class Scaffold : public testing::TestWithParam<NewNode> {};

// Building, testing and running a scaffold whole takes a build of its own; what rots first is that it compiles.
TEST_P(Scaffold, CompilesWithoutAWarning) {
  auto command = compile_command();
  ASSERT_FALSE(command.empty());
  const test::TempFolder folder;
  const auto files = scaffold("lattice.new_node", GetParam());
  ASSERT_EQ(files.size(), 4u);
  for (const ScaffoldFile& f : files) {
    fs::create_directories(fs::path(folder.file(f.path)).parent_path());
    folder.write(f.path, f.text);
    EXPECT_THAT(f.text, testing::Not(HasSubstr("@")));
  }
  // The header that CMake generates for every family.
  folder.write("nodes/lattice.h",
               "namespace frustum {\nclass NodeType;\n}\n"
               "namespace frustum::nodes {\nNodeType lattice_new_node();\n}\n");
  for (const char* option : {"-fsyntax-only", "-Werror", "-I"}) command.emplace_back(option);
  command.push_back(folder.path());
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
    auto one = command;
    one.push_back(folder.file(files[i].path));
    const auto r = test::run_process(one, FRUSTUM_SOURCE_DIR);
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_THAT(r.err, IsEmpty());
  }
}

TEST_P(Scaffold, ItsGraphIsOneOfTheFormat) {
  const auto graph = Json::parse(scaffold("lattice.new_node", GetParam()).at(3).text);
  EXPECT_EQ(graph["format"], "frustum.graph/1");
  EXPECT_THAT(graph.dump(), HasSubstr("\"type\":\"lattice.new_node\""));
}

INSTANTIATE_TEST_SUITE_P(Kinds, Scaffold, testing::Values(NewNode::geometry, NewNode::pixels),
                         [](const auto& info) {
                           return info.param == NewNode::geometry ? "geometry" : "pixels";
                         });

TEST(NewNode, NothingIsOverwritten) {
  const test::TempFolder folder;
  fs::create_directories(folder.file("nodes/curve"));
  folder.write("nodes/curve/arc.cpp", "mine");
  const auto r = test::frustum({"new", "curve.arc", "--root", folder.path()});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("nodes/curve/arc.cpp is already there"));
  EXPECT_FALSE(fs::exists(folder.file("nodes/curve/arc.h")));
}

TEST(NewNode, AFolderWithoutNodesIsNoSourceTree) {
  const test::TempFolder folder;
  const auto r = test::frustum({"new", "curve.arc", "--root", folder.path()});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("it has no folder nodes/"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

}  // namespace
}  // namespace frustum
