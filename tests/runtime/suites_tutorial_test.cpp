// docs/suites.md as a program: its files are written, its commands run in order, and each line that stands
// under a command has to begin a line of what the command says, in that order.
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

namespace frustum {
namespace {

namespace fs = std::filesystem;

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// The lines of the page, fence by fence, with the file that the text before a fence names last.
struct Block {
  std::string file, text;
};
std::vector<Block> blocks_of(const std::string& page) {
  std::vector<Block> blocks;
  std::istringstream in(page);
  std::string line, file;
  bool inside = false;
  const std::regex name("`([a-z_/]+[.](json|obj))`[.:]");
  while (std::getline(in, line)) {
    if (line.starts_with("```")) {
      inside = !inside;
      if (inside) blocks.push_back({std::exchange(file, ""), ""});
    } else if (inside) {
      blocks.back().text += line + "\n";
    } else if (std::smatch m; std::regex_search(line, m, name)) {
      file = m[1];
    }
  }
  return blocks;
}

void run_commands(const std::string& text, const test::TempFolder& folder) {
  std::istringstream in(text);
  std::string line;
  std::istringstream said;
  std::string command;
  while (std::getline(in, line)) {
    if (line.starts_with("$ ")) {
      command = line.substr(2);
      const auto r = test::run_process(
          {"/bin/sh", "-c", command}, folder.path(),
          {"PATH=" + fs::path(test::frustum_program()).parent_path().string() + ":/usr/bin:/bin"});
      EXPECT_EQ(r.code, 0) << command << "\n" << r.out << r.err;
      said = std::istringstream(r.out);
      continue;
    }
    std::string found;
    bool there = false;
    while (!there && std::getline(said, found)) there = found.starts_with(line);
    EXPECT_TRUE(there) << "after $ " << command << "\nno line begins with: " << line;
  }
}

TEST(SuitesTutorial, RunsAsWritten) {
  const test::TempFolder folder;
  fs::create_directories(folder.file("suites"));
  int files = 0, commands = 0;
  for (const Block& b : blocks_of(content(std::string(FRUSTUM_SOURCE_DIR) + "/docs/suites.md"))) {
    if (!b.file.empty()) {
      folder.write(b.file, b.text);
      ++files;
    } else if (b.text.starts_with("$ ")) {
      run_commands(b.text, folder);
      ++commands;
    }
  }
  EXPECT_EQ(files, 3);
  EXPECT_GE(commands, 4);
}

}  // namespace
}  // namespace frustum
