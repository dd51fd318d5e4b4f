#include "runtime/app/files.h"

#include "runtime/core/error.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace frustum {
namespace {

using test::TempFolder;

std::vector<std::string> found(const TempFolder& folder, const std::string& pattern) {
  std::vector<std::string> names;
  for (const auto& path : matching_files(folder.file(pattern))) names.push_back(path.filename().string());
  return names;
}

TEST(MatchingFiles, AStarIsAnyRunOfCharacters) {
  const TempFolder folder;
  for (const char* name : {"ab.json", "abab.json", "b.json", "a.txt"}) folder.write(name, "");
  using Names = std::vector<std::string>;
  EXPECT_EQ(found(folder, "*.json"), (Names{"ab.json", "abab.json", "b.json"}));
  EXPECT_EQ(found(folder, "a*b.json"), (Names{"ab.json", "abab.json"}));
  EXPECT_EQ(found(folder, "*ab*ab*"), (Names{"abab.json"}));
  EXPECT_EQ(found(folder, "**a**.t*t"), (Names{"a.txt"}));
  EXPECT_EQ(found(folder, "*c*"), Names{});
}

// Tried one after the other, the ways to share 200 letters among 30 stars are more than 10^35.
TEST(MatchingFiles, ManyStarsCostNoMore) {
  const TempFolder folder;
  folder.write(std::string(200, 'a'), "");
  std::string pattern;
  for (int i = 0; i < 30; ++i) pattern += "*a";
  EXPECT_EQ(found(folder, pattern + "*").size(), 1u);
  EXPECT_EQ(found(folder, pattern + "*b").size(), 0u);
}

TEST(ReadText, TakesFilesOfAnySize) {
  const TempFolder folder;
  for (const std::size_t size : {0u, 1u, 4095u, 4096u, 100000u}) {
    const std::string text(size, 'x');
    EXPECT_EQ(read_text(folder.write("f", text)), text);
  }
  EXPECT_FALSE(read_text("/proc/self/status").empty()) << "a regular file that says it has no bytes";
}

}  // namespace
}  // namespace frustum
