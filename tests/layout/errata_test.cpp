// Every erratum of the course notes that a source, a page or an example cites stands in docs/errata.md.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// What follows "errata" or "erratum" within its sentence: "errata E6 to E8 and E44" is E6, E7, E8 and E44.
std::set<int> cited_in(const std::string& text) {
  static const std::regex sentence(R"re([Ee]rrat(?:a|um)\b((?:[^.;:")\n]|\n[ \t]*///?)*))re");
  static const std::regex number(R"re(\bE(\d+)(?:(?: to |-)E(\d+))?\b)re");
  std::set<int> cited;
  for (std::sregex_iterator s(text.begin(), text.end(), sentence), end; s != end; ++s) {
    const std::string part = (*s)[1];
    for (std::sregex_iterator n(part.begin(), part.end(), number); n != end; ++n) {
      const int first = std::stoi((*n)[1]), last = (*n)[2].matched ? std::stoi((*n)[2]) : first;
      for (int e = first; e <= last; ++e) cited.insert(e);
    }
  }
  return cited;
}

// The numbers of the entries, "- **E10, E11** ...", in their order.
std::vector<int> listed_in(const std::string& page) {
  static const std::regex entry(R"re((?:^|\n)- \*\*(E\d+(?:, E\d+)*)\*\* \S)re"), number(R"re(\d+)re");
  std::vector<int> listed;
  for (std::sregex_iterator e(page.begin(), page.end(), entry), end; e != end; ++e) {
    const std::string names = (*e)[1];
    for (std::sregex_iterator n(names.begin(), names.end(), number); n != end; ++n)
      listed.push_back(std::stoi(n->str()));
  }
  return listed;
}

TEST(Errata, AreFoundInTexts) {
  EXPECT_THAT(cited_in("// one thing: errata E6 to E8 and\n// E44. E9 is none of them"),
              testing::ElementsAre(6, 7, 8, 44));
  EXPECT_THAT(cited_in(".cite(\"Errata E11 and E13: why, E14\")"), testing::ElementsAre(11, 13));
  EXPECT_THAT(cited_in("the exponent E7 is none"), testing::IsEmpty());
  EXPECT_THAT(listed_in("- **E1** a\n- **E10, E11** b, see E12\n"), testing::ElementsAre(1, 10, 11));
}

TEST(Errata, ThatAreCitedAreListedOnce) {
  const fs::path root(FRUSTUM_SOURCE_DIR);
  const std::vector<int> listed = listed_in(text_of(root / "docs/errata.md"));
  EXPECT_THAT(listed, testing::Contains(testing::Lt(87)).Times(static_cast<int>(listed.size())))
      << "the notes' list ends at E86";
  const std::set<int> known(listed.begin(), listed.end());
  EXPECT_EQ(known.size(), listed.size()) << "one is listed twice";
  std::set<int> all;
  for (const char* folder : {"nodes", "runtime", "docs", "graphs", "tests"})
    for (const auto& file : fs::recursive_directory_iterator(root / folder)) {
      const auto extension = file.path().extension();
      if (extension != ".h" && extension != ".cpp" && extension != ".md" && extension != ".json") continue;
      if (file.path().filename() == "errata.md" || file.path().filename() == "errata_test.cpp") continue;
      const std::set<int> cited = cited_in(text_of(file.path()));
      for (const int e : cited)
        EXPECT_TRUE(known.contains(e))
            << file.path().string() << " cites E" << e << ", docs/errata.md does not";
      all.insert(cited.begin(), cited.end());
    }
  EXPECT_GT(all.size(), 15u);
}

}  // namespace
