// `frustum run --cache`: across processes, at once, and when the folder is bad.
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>

namespace frustum {
namespace {

using nlohmann::json;
using test::frustum;
using test::ProcessResult;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string teapot = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot.json";

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

ProcessResult run_teapot(const TempFolder& folder, std::vector<std::string> more, int samples = 2,
                         const std::vector<std::string>& environment = {}) {
  std::vector<std::string> all = {"run",   teapot,
                                  "--set", "resolution=[160, 90]",
                                  "--set", "samples=" + std::to_string(samples),
                                  "--out", folder.file("out"),
                                  "--json"};
  all.insert(all.end(), more.begin(), more.end());
  return frustum(all, {}, environment);
}

json node_of(const ProcessResult& r, const std::string& id) {
  const json out = json::parse(r.out);
  for (const json& n : out["cache"])
    if (n["node"] == id) return n;
  return {};
}

TEST(CacheCli, ASecondProcessFindsWhatTheFirstStored) {
  const TempFolder folder;
  const std::string dir = folder.file("cache");
  const auto cold = run_teapot(folder, {"--cache", dir});
  ASSERT_EQ(cold.code, 0) << cold.err;
  EXPECT_EQ(node_of(cold, "display")["verdict"], "miss");
  EXPECT_EQ(node_of(cold, "display")["kept"], "stored");
  EXPECT_EQ(node_of(cold, "draw/lit")["kept"], "not_whole");
  const std::string bytes = text_of(folder.file("out/teapot.png"));
  std::filesystem::remove(folder.file("out/teapot.png"));

  const auto warm = run_teapot(folder, {"--cache", dir});
  ASSERT_EQ(warm.code, 0) << warm.err;
  EXPECT_EQ(node_of(warm, "display")["verdict"], "hit");
  EXPECT_EQ(node_of(warm, "display")["from"], "disk");
  EXPECT_EQ(node_of(warm, "mesh")["verdict"], "not_needed");
  EXPECT_EQ(text_of(folder.file("out/teapot.png")), bytes);

  const auto more = run_teapot(folder, {"--cache", dir}, 4);
  EXPECT_EQ(node_of(more, "display")["why"], "input_changed");
  EXPECT_EQ(node_of(more, "draw/pattern")["why"], "params_changed");
  EXPECT_EQ(node_of(more, "draw/pattern")["detail"], "samples");

  const auto events = frustum({"run", teapot, "--set", "resolution=[160, 90]", "--set", "samples=4", "--out",
                               folder.file("out"), "--cache", dir, "--events"});
  EXPECT_THAT(events.err, AllOf(HasSubstr("\"event\":\"cached\""), HasSubstr("\"verdict\":\"hit\"")));
}

TEST(CacheCli, CheckIsExit1ForAFileThatIsNotWhatTheNodeMakes) {
  const TempFolder folder;
  const std::string dir = folder.file("cache");
  ASSERT_EQ(run_teapot(folder, {"--cache", dir}).code, 0);
  const auto good = run_teapot(folder, {"--cache", dir, "--cache", "check"});
  EXPECT_EQ(good.code, 0) << good.err << good.out;
  EXPECT_EQ(node_of(good, "display")["kept"], "same");
  EXPECT_NE(node_of(good, "mesh")["kept"], "differs") << "it may be too quick to make to be kept at all";
}

TEST(CacheCli, BypassedByOffAndRepeat) {
  const TempFolder folder;
  const std::string dir = folder.file("cache");
  const auto off = run_teapot(folder, {"--cache", "off"}, 2, {"FRUSTUM_CACHE=" + dir});
  EXPECT_EQ(node_of(off, "display")["verdict"], "off");
  const auto repeat = run_teapot(folder, {"--repeat", "1", "--cache", dir});
  EXPECT_EQ(node_of(repeat, "display")["verdict"], "off");
  run_teapot(folder, {}, 2, {"FRUSTUM_CACHE=" + dir});
  EXPECT_EQ(node_of(run_teapot(folder, {"--cache", dir}), "display")["verdict"], "hit");
}

TEST(CacheCli, WrongUseIsExit2AndAnUnusableFolderExit3) {
  const TempFolder folder;
  EXPECT_EQ(run_teapot(folder, {"--cache", "check"}).code, 2);
  EXPECT_EQ(run_teapot(folder, {"--cache", "off", "--cache", "check"}).code, 2);
  EXPECT_EQ(run_teapot(folder, {"--cache", folder.file("c"), "--cache-size", "much"}).code, 2);
  const auto file = run_teapot(folder, {"--cache", folder.write("file", "")});
  EXPECT_EQ(file.code, 3);
  EXPECT_THAT(file.err + file.out, HasSubstr("cannot be used as a folder for the cache"));
}

TEST(CacheCli, ADamagedFileIsSaidAndThePictureIsRight) {
  const TempFolder folder;
  const std::string dir = folder.file("cache");
  ASSERT_EQ(run_teapot(folder, {"--cache", dir}).code, 0);
  const std::string bytes = text_of(folder.file("out/teapot.png"));
  for (const auto& e : std::filesystem::recursive_directory_iterator(dir + "/objects"))
    if (e.is_regular_file()) {
      std::string content = text_of(e.path());
      char& middle = content[content.size() / 2];
      middle = static_cast<char>(middle ^ 4);
      std::ofstream(e.path(), std::ios::binary) << content;
    }
  std::filesystem::remove(folder.file("out/teapot.png"));
  const auto r = run_teapot(folder, {"--cache", dir});
  EXPECT_EQ(r.code, 0);
  EXPECT_THAT(r.out, HasSubstr("cache_damaged"));
  EXPECT_EQ(text_of(folder.file("out/teapot.png")), bytes);
}

TEST(CacheCli, ProcessesShareAFolderAtTheSameTime) {
  const TempFolder folder;
  const std::string dir = folder.file("cache");
  std::vector<ProcessResult> results(6);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < results.size(); ++i)
      threads.emplace_back([&, i] {
        // Two sizes of limit: some of them evict while others read and write.
        results[i] =
            frustum({"run", teapot, "--set", "resolution=[96, 54]", "--set",
                     "samples=" + std::to_string(1 + i % 2), "--out", folder.file("out" + std::to_string(i)),
                     "--cache", dir, "--cache-size", i % 3 == 0 ? "1500K" : "1G", "--json"});
      });
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_EQ(results[i].code, 0) << results[i].err;
    EXPECT_THAT(results[i].out, Not(HasSubstr("cache_damaged")));
    EXPECT_EQ(text_of(folder.file("out" + std::to_string(i) + "/teapot.png")),
              text_of(folder.file("out" + std::to_string(i % 2) + "/teapot.png")));
  }
}

}  // namespace
}  // namespace frustum
