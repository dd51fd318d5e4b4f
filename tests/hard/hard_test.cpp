// One test a hard case, named after it: the naive method fails, ours holds. And the catalogue is complete.
#include "runtime/app/files.h"
#include "runtime/app/stability/report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>

namespace frustum::stability {
namespace {

class HardCaseTest : public testing::Test {
 public:
  explicit HardCaseTest(const CatalogueRow& row) : row_(row) {}
  void TestBody() override {
    const Outcome o = run_case(hard_cases(), row_, {.timed = false});
    EXPECT_EQ(name_of(o.state), name_of(State::holds)) << row_.title << ": " << o.why;
    RecordProperty("naive", error_text(o.naive.worst));
    RecordProperty("robust", error_text(o.robust.worst));
  }

 private:
  const CatalogueRow& row_;
};

const CatalogueRow* row_of(std::string_view id) {
  for (const CatalogueRow& row : hard_cases().catalogue)
    if (row.id == id) return &row;
  return nullptr;
}

const bool registered = [] {
  for (const HardCase& hard : hard_cases().cases) {
    const CatalogueRow* row = row_of(hard.id);
    const auto& argued = hard_cases().argued;
    if (std::any_of(argued.begin(), argued.end(), [&](const auto& a) { return a.id == hard.id; })) continue;
    if (row == nullptr) continue;  // the catalogue's own test says so
    std::string name(hard.id);
    std::replace(name.begin(), name.end(), '-', '_');
    testing::RegisterTest("Hard", name.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                          [row]() -> HardCaseTest* { return new HardCaseTest(*row); });
  }
  return true;
}();

TEST(HardCatalogue, NamesEveryIdOnceAndSaysWhatBecameOfIt) {
  ASSERT_TRUE(registered);
  const HardCases& all = hard_cases();
  EXPECT_EQ(all.catalogue.size(), 205u);
  std::multiset<std::string_view> cases, argued;
  std::set<std::string_view> ids;
  for (const HardCase& c : all.cases) cases.insert(c.id);
  for (const ArguedCase& a : all.argued) argued.insert(a.id);
  for (const CatalogueRow& row : all.catalogue) {
    EXPECT_TRUE(ids.insert(row.id).second) << row.id << " twice";
    EXPECT_LE(cases.count(row.id), 1u) << row.id;
    EXPECT_LE(argued.count(row.id), 1u) << row.id;
    const bool taken = cases.contains(row.id) || argued.contains(row.id);
    EXPECT_EQ(taken, row.needs.empty())
        << row.id << (taken ? " has a case and waits for one" : " has neither a case nor an argument");
  }
  for (const std::string_view id : cases) EXPECT_TRUE(ids.contains(id)) << id;
  for (const std::string_view id : argued) EXPECT_TRUE(ids.contains(id)) << id;
}

TEST(HardCatalogue, SaysAllOfEachCase) {
  for (const HardCase& c : hard_cases().cases)
    for (const std::string_view text : {c.input, c.naive, c.robust, c.oracle, c.criterion, c.unit})
      EXPECT_FALSE(text.empty()) << c.id;
}

// The page lists each id in the section of its state. Errors and prices may differ: machines do.
TEST(HardCatalogue, IsWhatThePageSays) {
  const HardCases& all = hard_cases();
  const std::string page = read_text(std::string(FRUSTUM_SOURCE_DIR) + "/docs/stability.md");
  const auto argued_at = page.find("\n## Argued\n"), waiting_at = page.find("\n## Not built yet\n");
  ASSERT_NE(argued_at, std::string::npos);
  ASSERT_NE(waiting_at, std::string::npos);
  constexpr const char* how = ": write it anew with build/release/bin/frustum stability --docs docs";
  for (const CatalogueRow& row : all.catalogue) {
    const std::string line = "\n| " + std::string(row.id) + " |";
    const auto at = page.find(line);
    ASSERT_NE(at, std::string::npos) << row.id << " is missing" << how;
    EXPECT_EQ(page.find(line, at + 1), std::string::npos) << row.id << " twice" << how;
    const bool argued =
        std::any_of(all.argued.begin(), all.argued.end(), [&](const auto& a) { return a.id == row.id; });
    EXPECT_EQ(at > argued_at && at < waiting_at, argued) << row.id << how;
    EXPECT_EQ(at > waiting_at, !row.needs.empty()) << row.id << how;
  }
  for (const Illustration& p : all.pictures) {
    EXPECT_NE(page.find(p.file), std::string::npos) << p.file << how;
    EXPECT_TRUE(
        std::filesystem::exists(std::string(FRUSTUM_SOURCE_DIR) + "/docs/images/" + std::string(p.file)))
        << p.file << how;
  }
  EXPECT_NE(page.find("**" +
                      std::to_string(all.cases.size() -
                                     static_cast<std::size_t>(std::count_if(
                                         all.cases.begin(), all.cases.end(),
                                         [&](const HardCase& c) {
                                           return std::any_of(all.argued.begin(), all.argued.end(),
                                                              [&](const auto& a) { return a.id == c.id; });
                                         }))) +
                      " hold**"),
            std::string::npos)
      << "the number of cases" << how;
}

TEST(HardCatalogue, ArguesInItsDecision) {
  const std::string decision =
      read_text(std::string(FRUSTUM_SOURCE_DIR) + "/docs/decisions/0003-hard-cases.md");
  for (const ArguedCase& a : hard_cases().argued)
    EXPECT_NE(decision.find("\n### " + std::string(a.id)), std::string::npos) << a.id;
}

}  // namespace
}  // namespace frustum::stability
