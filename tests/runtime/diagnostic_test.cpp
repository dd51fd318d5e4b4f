#include "runtime/core/diagnostic.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

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

TEST(NearestNames, AreNotFarNames) {
  EXPECT_TRUE(nearest_names("teapot", Names{"camera", "tea"}).empty());
  EXPECT_EQ(nearest_names("teapot", Names{"teap"}), Names{"teap"});
  EXPECT_TRUE(nearest_names("", Names{"a"}).empty());
  EXPECT_TRUE(nearest_names(std::string(1000000, 'a'), Names{"a"}).empty());
}

}  // namespace
}  // namespace frustum
