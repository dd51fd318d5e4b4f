#include "runtime/graph/source_text.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <random>

namespace frustum {
namespace {

struct Read {
  std::shared_ptr<const SourceText> text;
  Diagnostics problems;
};

Read read(std::string text) {
  Read r;
  r.text = SourceText::read(std::move(text), "t.json", r.problems);
  return r;
}

std::string first(const Read& r) {
  if (r.problems.empty()) return "";
  const Diagnostic& d = r.problems.list()[0];
  return d.code + " " + std::to_string(d.line) + ":" + std::to_string(d.column) + " " + d.pointer + " " +
         d.message;
}

std::string place(TextPlace p) { return std::to_string(p.line) + ":" + std::to_string(p.column); }

TEST(SourceText, KnowsWhereKeysAndValuesStand) {
  const Read r = read("{\n  \"nodes\": {\n    \"cut\": { \"type\": [1,\n 22] } } }");
  EXPECT_TRUE(r.problems.empty());
  EXPECT_EQ(place(r.text->value_place("")), "1:1");
  EXPECT_EQ(place(r.text->key_place("/nodes/cut")), "3:5");
  EXPECT_EQ(place(r.text->value_place("/nodes/cut")), "3:12");
  EXPECT_EQ(place(r.text->value_place("/nodes/cut/type/1")), "4:2");
  EXPECT_EQ(place(r.text->key_place("/nodes/cut/type/1")), "4:2");
}

TEST(SourceText, APointerThatLeadsNowhereIsAtItsDeepestPart) {
  const Read r = read("{\"a\": {\"b\": [1]}}");
  EXPECT_EQ(place(r.text->value_place("/a/x/y")), "1:7");
  EXPECT_EQ(place(r.text->value_place("/a/b/7")), "1:13");
  EXPECT_EQ(place(r.text->value_place("/a/b/-1")), "1:13");
}

TEST(SourceText, EscapedNamesAreFoundByWhatTheyMean) {
  const Read r = read(R"({"a/b": 1, "c~d": 2, "\u0065": 3, "": 4})");
  EXPECT_EQ(place(r.text->value_place("/a~1b")), "1:9");
  EXPECT_EQ(place(r.text->value_place("/c~0d")), "1:19");
  EXPECT_EQ(place(r.text->value_place("/e")), "1:32");
  EXPECT_EQ(place(r.text->value_place("/")), "1:39");
}

TEST(SourceText, ColumnsCountCodePoints) {
  const Read r = read("{\"\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80\": 1}");
  EXPECT_EQ(place(r.text->value_place("/\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80")), "1:9");
}

struct Wrong {
  std::string text, first;
};
class SourceTextProblems : public testing::TestWithParam<Wrong> {};

TEST_P(SourceTextProblems, AreNamedWithTheirPlace) {
  EXPECT_EQ(first(read(GetParam().text)), GetParam().first);
}

INSTANTIATE_TEST_SUITE_P(
    All, SourceTextProblems,
    testing::Values(
        Wrong{"", "not_json 1:1  the text is empty"}, Wrong{" \n ", "not_json 2:2  the text is empty"},
        Wrong{"{\"a\": [1,", "not_json 1:10 /a the text ends inside an array"},
        Wrong{"{\"a\": 1", "not_json 1:8  the text ends inside an object"},
        Wrong{"{\"a\": \"b", "not_json 1:9 /a the text ends inside a text"},
        Wrong{"{\"a\":", "not_json 1:6 /a the text ends where a value should stand"},
        Wrong{"{\"a\"", "not_json 1:5 /a the text ends inside an object"},
        Wrong{"{\"a\": 1,}", "not_json 1:8  nothing stands between ',' and '}'"},
        Wrong{"[1, , 2]", "not_json 1:3  nothing stands between ',' and ','"},
        Wrong{"[1 2]", "not_json 1:4  expected ',' or ']', got '2'"},
        Wrong{"[1}", "not_json 1:3  expected ',' or ']', got '}'"},
        Wrong{"{\"a\" 1}", "not_json 1:6 /a expected ':' after the key 'a', got '1'"},
        Wrong{"{a: 1}", "not_json 1:2  the key a has no double quotes"},
        Wrong{"{'a': 1}", "not_json 1:2  expected a key in double quotes, got '''"},
        Wrong{"['a']", "not_json 1:2 /0 texts stand in double quotes"},
        Wrong{"[True]", "not_json 1:2 /0 'True' is written true"},
        Wrong{"[None]", "not_json 1:2 /0 'None' is written null"},
        Wrong{"[nul]", "not_json 1:2 /0 expected a value, got 'nul'"},
        Wrong{"// x\n1", "not_json 1:1  JSON has no comments"},
        Wrong{"[1 /* x", "not_json 1:4  JSON has no comments"},
        Wrong{"[] []", "not_json 1:4  '[' follows after the end of the document"},
        Wrong{"[01]", "not_json 1:2 /0 '01' is not how JSON writes a number"},
        Wrong{"[.5]", "not_json 1:2 /0 '.5' is not how JSON writes a number"},
        Wrong{"[1.]", "not_json 1:2 /0 '1.' is not how JSON writes a number"},
        Wrong{"[0x10]", "not_json 1:2 /0 '0x10' is not how JSON writes a number"},
        Wrong{"[\"\\q\"]", "not_json 1:3 /0 '\\q' is not an escape of JSON"},
        Wrong{"[\"\\ud800\"]",
              "not_json 1:3 /0 '\\u' needs four hexadecimal digits, and halves of a pair stand together"},
        Wrong{"[\"a\tb\"]", "not_json 1:4 /0 byte 0x09 in a text is written as an escape"},
        Wrong{"[\"a\n\"]", "not_json 1:2 /0 this text has no closing quote on its line"},
        Wrong{"[\"\xC0\xAF\"]", "not_json 1:3 /0 byte 0xC0 is not UTF-8"},
        Wrong{"\xEF\xBB\xBF[]", "not_json 1:1  the text starts with a byte-order mark"},
        Wrong{"[NaN]", "not_finite 1:2 /0 'NaN' is not a number"},
        Wrong{"[-Infinity]", "not_finite 1:2 /0 '-Infinity' is not a number"},
        Wrong{"[1, 1e999]", "not_finite 1:5 /1 1e999 is beyond the largest number, 1.8e308"},
        Wrong{"{\"a\": 1, \"b\": 2, \"\\u0061\": 3}",
              "duplicate_key 1:18 /a the key 'a' stands twice in this object"}));

TEST(SourceText, GoesOnWhereTheMeaningIsClear) {
  const Read r = read("{ // note\n \"a\": [1, 2,], \"b\": NaN \"c\": 3, \"a\": 4 }");
  std::vector<std::string> codes;
  for (const Diagnostic& d : r.problems.list()) codes.push_back(d.code);
  EXPECT_EQ(codes,
            (std::vector<std::string>{"not_json", "not_json", "not_finite", "not_json", "duplicate_key"}));
  EXPECT_TRUE(r.text->complete());
  EXPECT_EQ(r.text->json(), Json::parse(R"({"a": [1, 2], "b": 0, "c": 3})"));
}

TEST(SourceText, AHundredThousandBracketsAreOneProblem) {
  for (const std::string open : {"[", "{\"a\":"}) {
    std::string text;
    for (int i = 0; i < 100000; ++i) text += open;
    const Read r = read(text);
    ASSERT_EQ(r.problems.size(), 1u);
    EXPECT_EQ(r.problems.list()[0].code, "too_deep");
    EXPECT_FALSE(r.text->complete());
  }
}

TEST(SourceText, TheDepthLimitItselfIsAllowed) {
  const auto nested = [](int n) {
    const auto count = static_cast<std::size_t>(n);
    return std::string(count, '[') + std::string(count, ']');
  };
  EXPECT_TRUE(read(nested(SourceText::max_depth)).problems.empty());
  EXPECT_EQ(read(nested(SourceText::max_depth + 1)).problems.list()[0].code, "too_deep");
}

TEST(SourceText, ManyProblemsEndTheReading) {
  const Read r = read("[" + std::string(1000, ',') + "]");
  EXPECT_EQ(r.problems.size(), 1u);  // the first ',' stands where a value should
  std::string commas = "[0";
  for (int i = 0; i < 1000; ++i) commas += ",,0";
  EXPECT_EQ(read(commas + "]").problems.size(), 20u);
}

TEST(SourceText, NumbersKeepTheirKindAndEveryBit) {
  const Read r = read(
      "[0, -1, 18446744073709551615, 18446744073709551616, 0.1, 1e-400, 4.9e-324, 1.7976931348623157e308]");
  EXPECT_TRUE(r.problems.empty());
  const Json expected = Json::parse(r.text->json().dump());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(r.text->json()[i].type(), expected[i].type()) << i;
  EXPECT_EQ(r.text->json()[4].get<double>(), 0.1);
  EXPECT_EQ(r.text->json()[5].get<double>(), 0.0);
  EXPECT_EQ(r.text->json()[6].get<double>(), 4.9e-324);
}

// Text is a problem here exactly where the library refuses it, and read to the same value where it does not; but for
// what only we refuse: duplicate keys, a byte-order mark and depth.
TEST(SourceText, AgreesWithTheLibraryOnMutatedText) {
  const std::string seed =
      R"({"format": "frustum.graph/1", "params": {"a": [1, -2.5e3, true, null], "b\u00e9": "x\n\ud83d\ude00é"},)"
      "\n"
      R"( "nodes": {"n": {"type": "t", "in": {"x": ["a.b", {"value": 0.25}]}}}})";
  const std::string alphabet = "{}[]\",:0123456789.eE+-\\u/ \n\tabtfn\x80\xC3\xA9\xED\xF4";
  std::mt19937 random(1);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = seed;
    for (std::size_t n = 1 + below(3); n > 0 && !text.empty(); --n) {
      const std::size_t at = below(text.size());
      switch (below(4)) {
        case 0: text[at] = alphabet[below(alphabet.size())]; break;
        case 1: text.insert(at, 1, alphabet[below(alphabet.size())]); break;
        case 2: text.erase(at, 1 + below(3)); break;
        default: text.resize(at + 1); break;
      }
    }
    const Read r = read(text);
    bool wrong = false, twice = false;
    for (const Diagnostic& d : r.problems.list()) {
      ASSERT_GT(d.line, 0);
      ASSERT_GT(d.column, 0);
      (d.code == "duplicate_key" ? twice : wrong) = true;
    }
    const Json theirs = Json::parse(text, nullptr, false);
    ASSERT_EQ(theirs.is_discarded(), wrong) << text;
    if (!wrong && !twice) {
      ASSERT_EQ(theirs, r.text->json()) << text;
    }
    refused += wrong;
  }
  EXPECT_GT(refused, 10000);
  EXPECT_LT(refused, 20000);
}

}  // namespace
}  // namespace frustum
