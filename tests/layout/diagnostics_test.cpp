// Every code of a diagnostic stands in docs/diagnostics.md. Codes are read from the text of the sources, where
// they are the first argument of what makes a diagnostic.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

std::set<std::string> codes_in(const std::string& source) {
  static const std::regex made(R"re((?:NodeError|WorldError|warn|problem|fail)\(\s*"([a-z]+(?:_[a-z]+)*)",)re"
                               R"re(|\.code = "([a-z]+(?:_[a-z]+)*)")re");
  std::set<std::string> codes;
  for (std::sregex_iterator it(source.begin(), source.end(), made), end; it != end; ++it)
    codes.insert((*it)[1].matched ? (*it)[1] : (*it)[2]);
  return codes;
}

TEST(Diagnostics, CodesAreFoundInSources) {
  EXPECT_THAT(codes_in("throw NodeError(\"no_file\", x); d = {.code = \"cycle\"}; ctx.warn(\n \"odd\", f());"
                       "throw std::logic_error(\"broken\"); at(\"key\", 1);"),
              testing::ElementsAre("cycle", "no_file", "odd"));
}

TEST(Diagnostics, EveryCodeIsDocumented) {
  const fs::path root(FRUSTUM_SOURCE_DIR);
  const std::string docs = text_of(root / "docs/diagnostics.md");
  std::set<std::string> codes, missing;
  for (const char* folder : {"nodes", "runtime"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
        codes.merge(codes_in(text_of(entry.path())));
  EXPECT_GT(codes.size(), 60u);
  for (const std::string& code : codes)
    if (docs.find("`" + code + "`") == std::string::npos &&
        docs.find("### " + code + "\n") == std::string::npos)
      missing.insert(code);
  EXPECT_THAT(missing, testing::IsEmpty());
}

}  // namespace
