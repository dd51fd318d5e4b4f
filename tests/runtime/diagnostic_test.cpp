#include "runtime/core/diagnostic.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <random>

namespace frustum {
namespace {

using Names = std::vector<std::string>;

Diagnostics one() {
  Diagnostics d;
  d.add({.code = "unknown_type",
         .pointer = "/nodes/cut/type",
         .message = "'clip.homogenous' is not a node type",
         .got = "clip.homogenous",
         .suggestions = {"clip.homogeneous"},
         .related = {{.pointer = "/nodes/cut", .message = "the node", .line = 16, .column = 5}},
         .file = "teapot.json",
         .line = 17,
         .column = 24});
  return d;
}

TEST(Diagnostics, TextNamesThePlaceTheProblemTheOtherEndAndTheRemedy) {
  EXPECT_EQ(to_text(one()),
            "error[unknown_type] teapot.json:17:24 /nodes/cut/type\n"
            "  'clip.homogenous' is not a node type\n"
            "  teapot.json:16:5 /nodes/cut: the node\n"
            "  did you mean 'clip.homogeneous'?\n");
}

TEST(Diagnostics, TextOfAWarningWithoutAFileHasNoEmptyParts) {
  Diagnostics d;
  d.add(
      {.code = "no_outputs", .severity = Severity::warning, .pointer = "", .message = "nothing is written"});
  EXPECT_EQ(to_text(d), "warning[no_outputs]\n  nothing is written\n");
  EXPECT_FALSE(d.has_errors());
}

TEST(Diagnostics, TextShowsTwentyOfACodeAndCountsTheRest) {
  Diagnostics d;
  for (int i = 0; i < 1000; ++i) {
    const std::string pointer = "/nodes/n" + std::to_string(i);
    d.add({.code = "unused_node", .severity = Severity::warning, .pointer = pointer, .message = "not read"});
    if (i < 20) d.add({.code = "unknown_type", .pointer = pointer, .message = "no type"});
  }
  const std::string text = to_text(d);
  EXPECT_NE(text.find("/nodes/n19\n  not read"), std::string::npos);
  EXPECT_NE(text.find("/nodes/n19\n  no type"), std::string::npos);
  EXPECT_EQ(text.find("/nodes/n20"), std::string::npos);
  EXPECT_TRUE(text.ends_with("warning[unused_node] and 980 more; --json names them all\n")) << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2 * 40 + 1);
  EXPECT_EQ(to_json(d)["diagnostics"].size(), 1020u);
}

TEST(Diagnostics, ColourWrapsOnlyWhatPlainTextHas) {
  std::string colored = to_text(one(), true);
  EXPECT_NE(colored.find("\x1b[1;31merror[unknown_type]\x1b[0m"), std::string::npos);
  for (std::size_t at; (at = colored.find('\x1b')) != std::string::npos;)
    colored.erase(at, colored.find('m', at) - at + 1);
  EXPECT_EQ(colored, to_text(one()));
}

TEST(Diagnostics, ControlCharactersOfTheUserDoNotReachTheTerminal) {
  Diagnostics d;
  d.add({.code = "unknown_key", .pointer = "/a\nb", .message = "\x1b[2J is unknown"});
  EXPECT_EQ(to_text(d), "error[unknown_key] /a\\x0ab\n  \\x1b[2J is unknown\n");
}

TEST(Diagnostics, JsonHasEveryFieldEvenWhereItIsEmpty) {
  const Json j = to_json(one())["diagnostics"][0];
  const Names keys = {"code",    "severity", "file", "pointer",     "line",   "column",
                      "message", "expected", "got",  "suggestions", "related"};
  Names found;
  for (const auto& [key, value] : j.items()) found.push_back(key);
  EXPECT_EQ(found, keys);
  EXPECT_EQ(j["related"][0]["line"], 16);
}

TEST(Pointers, EscapeTildeAndSlash) {
  EXPECT_EQ(child_pointer("/a", "b/c~d"), "/a/b~1c~0d");
  EXPECT_EQ(child_pointer("", std::size_t{12}), "/12");
  EXPECT_EQ(child_pointer("", ""), "/");
}

TEST(NearestNames, ASwapCountsOneEdit) {
  EXPECT_EQ(nearest_names("eys", Names{"eye", "yes", "ab"}), (Names{"eye", "yes"}));
  EXPECT_EQ(nearest_names("naer", Names{"all", "near"}), Names{"near"});
}

TEST(NearestNames, AreThreeAtMostNearestFirst) {
  EXPECT_EQ(nearest_names("color", Names{"colxyr", "colour", "colxr", "color2", "dolor"}),
            (Names{"colour", "colxr", "color2"}));
}

TEST(NearestNames, OfShortNamesAreOneEditAway) {
  EXPECT_TRUE(nearest_names("ab", Names{"abc", "b", "cd"}).empty());
  EXPECT_EQ(nearest_names("ab", Names{"abc", "ad"}), Names{"ad"});
  EXPECT_TRUE(nearest_names("lit.xa", Names{"lit.xbc"}).empty()) << "what both begin with counts for neither";
}

TEST(NearestNames, BesideANearNameFarOnesAreLeftOut) {
  EXPECT_EQ(nearest_names("light.ambeint", Names{"light.ambient", "light.point"}), (Names{"light.ambient"}));
}

TEST(NearestNames, WhereNoneIsNearTheShortestThatGoesOn) {
  EXPECT_EQ(nearest_names("clip.homo", Names{"clip.homogeneous", "clip.planes"}), Names{"clip.homogeneous"});
  EXPECT_EQ(nearest_names("displ", Names{"display.image", "display", "displaced"}), Names{"display"});
  EXPECT_EQ(nearest_names("ras", Names{"raster_b", "raster_a"}), Names{"raster_b"}) << "the first of equals";
  EXPECT_EQ(nearest_names("color", Names{"color_of_light", "colour"}), Names{"colour"}) << "a near one first";
  EXPECT_TRUE(nearest_names("clip.", Names{"clip.homogeneous"}).empty()) << "a family alone says too little";
  EXPECT_TRUE(nearest_names("clip.ho", Names{"clip.homogeneous"}).empty());
}

// Against the whole table of Damerau's recurrence, which the band cuts.
TEST(NearestNames, CountEditsLikeTheWholeTable) {
  const auto edits = [](const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
      for (std::size_t j = 0; j <= b.size(); ++j) {
        if (i == 0 || j == 0) {
          d[i][j] = i + j;
          continue;
        }
        d[i][j] =
            std::min({d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1), d[i - 1][j] + 1, d[i][j - 1] + 1});
        if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
          d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
      }
    return d[a.size()][b.size()];
  };
  std::mt19937 random(7);
  int near = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string a, b;
    for (std::size_t n = 6 + random() % 8; n != 0; --n) a += static_cast<char>('a' + random() % 3);
    b = a;
    for (std::size_t n = random() % 6; n != 0; --n) {
      const std::size_t at = random() % b.size();
      switch (random() % 3) {
        case 0: b[at] = static_cast<char>('a' + random() % 3); break;
        case 1: b.insert(at, 1, 'b'); break;
        default:
          if (at > 0) std::swap(b[at], b[at - 1]);
      }
    }
    const bool expected = edits(a, b) <= a.size() / 3 && 2 * edits(a, b) < std::max(a.size(), b.size());
    EXPECT_EQ(nearest_names(a, Names{b}).size(), expected || b.starts_with(a) ? 1u : 0u) << a << " " << b;
    near += expected;
  }
  EXPECT_GT(near, 5000);
  EXPECT_LT(near, 19000);
}

TEST(NearestNames, AreNotFarNames) {
  EXPECT_TRUE(nearest_names("teapot", Names{"camera", "tea"}).empty());
  EXPECT_EQ(nearest_names("teapot", Names{"teap"}), Names{"teap"});
  EXPECT_TRUE(nearest_names("", Names{"a"}).empty());
  EXPECT_TRUE(nearest_names(std::string(1000000, 'a'), Names{"a"}).empty());
}

}  // namespace
}  // namespace frustum
