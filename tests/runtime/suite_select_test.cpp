#include "runtime/app/suite/select.h"

#include <gmock/gmock.h>

namespace frustum {
namespace {

SuiteCase named(const std::string& id, std::vector<std::string> tags = {}) {
  SuiteCase c;
  c.id = id, c.tags = std::move(tags);
  return c;
}

TEST(Glob, MatchesTheWholeText) {
  EXPECT_TRUE(glob_matches("teapot", "teapot"));
  EXPECT_FALSE(glob_matches("teapot", "teapots"));
  EXPECT_TRUE(glob_matches("*pot*", "a teapot/x"));
  EXPECT_TRUE(glob_matches("a*b*c", "a-b-b-c"));
  EXPECT_FALSE(glob_matches("a*b*c", "a-c-b"));
  EXPECT_TRUE(glob_matches("t?a", "tea"));
  EXPECT_TRUE(glob_matches("**", ""));
  EXPECT_FALSE(glob_matches("?", ""));
  EXPECT_TRUE(glob_matches("t[samples=4]", "t[samples=4]")) << "brackets stand for themselves";
}

TEST(Glob, IsNotExponential) {
  const std::string text(2000, 'a');
  std::string pattern;
  for (int i = 0; i < 100; ++i) pattern += "a*";
  EXPECT_FALSE(glob_matches(pattern + "b", text));
}

TEST(Filter, TakesIdsTagsAndTheBeginningOfIds) {
  const SuiteCase c = named("pictures/teapot[samples=4]", {"slow", "gallery"});
  for (const char* f :
       {"pictures/teapot[samples=4]", "pictures", "pictures/teapot", "*teapot*", "slow", "gal*"})
    EXPECT_TRUE(chosen(c, {f})) << f;
  for (const char* f : {"teapot", "pict", "slo", "samples"}) EXPECT_FALSE(chosen(c, {f})) << f;
  EXPECT_TRUE(chosen(c, {"nothing", "slow"})) << "one is enough";
}

TEST(Filter, LeavesOut) {
  const SuiteCase c = named("a", {"slow"});
  EXPECT_FALSE(chosen(c, {"!slow"}));
  EXPECT_FALSE(chosen(c, {"a", "!slow"}));
  EXPECT_TRUE(chosen(c, {"!fast"}));
  EXPECT_FALSE(chosen(c, {"b", "!fast"}));
}

TEST(Shard, HoldsEveryCaseOnce) {
  for (const int count : {1, 2, 7}) {
    std::vector<int> sizes(static_cast<std::size_t>(count));
    for (int n = 0; n < 1000; ++n) {
      int parts = 0;
      for (int i = 1; i <= count; ++i)
        if (in_shard({i, count}, "s", "case " + std::to_string(n)))
          ++parts, ++sizes[static_cast<std::size_t>(i - 1)];
      EXPECT_EQ(parts, 1);
    }
    for (const int size : sizes) EXPECT_GT(size, 1000 / count / 2) << count;
  }
}

TEST(Shard, IsTheSameOnEveryMachine) {
  std::string parts;
  for (const char* id : {"a", "b", "c", "d", "e", "f", "teapot[samples=1]", "teapot[samples=4]"})
    for (int i = 1; i <= 3; ++i)
      if (in_shard({i, 3}, "gallery", id)) parts += std::to_string(i);
  EXPECT_EQ(parts, "11112321") << "who divides a suite among machines relies on it";
}

}  // namespace
}  // namespace frustum
