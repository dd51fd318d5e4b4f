// What a run makes of the folder that keeps buffers: what is found, what is kept, and what is said of it.
#include "runtime/buffers/value.h"
#include "runtime/graph/disk_cache.h"
#include "runtime/graph/keys.h"
#include "tests/support/pixel_nodes.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace frustum::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

// Takes 20 ms and warns; counts its runs.
namespace slow {
std::atomic<int> runs{0};
struct Inputs {
  std::optional<Ref<Number>> number;
};
struct Params {
  double add = 1;
  bool nan = false;
};
struct Outputs {
  Ref<Number> number;
};
Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  ++runs;
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  ctx.warn("slow", "this took long");
  const double value = (in.number ? (*in.number)->value : 0) + p.add;
  return {std::make_shared<Number>(Number{p.nan ? std::numeric_limits<double>::quiet_NaN() : value})};
}
const NodeType& type() {
  static const NodeType t = node("test.slow", run)
                                .doc("Slow.")
                                .input("number", &Inputs::number, "It.")
                                .param("add", &Params::add, "Added.")
                                .param("nan", &Params::nan, "A NaN.")
                                .output("number", &Outputs::number, "Sum.");
  return t;
}
}  // namespace slow

// early -> late, each slow.
Graph two_slow(const TempFolder& folder, double early, double late, bool nan = false) {
  Graph g;
  g.file = folder.file("graph.json");
  for (const auto& [id, add] : {std::pair{"early", early}, std::pair{"late", late}}) {
    GraphNode n{.id = id, .type = &slow::type(), .params = {}, .inputs = {}, .place = {}, .parts = {}};
    n.params = std::make_shared<const slow::Params>(slow::Params{add, nan && g.nodes.empty()});
    n.inputs.resize(1);
    if (!g.nodes.empty()) n.inputs[0].push_back(PortRef{0, 0});
    g.nodes.push_back(std::move(n));
  }
  return g;
}

RunResult run_with(const Graph& g, const std::string& folder, bool check = false) {
  DiskCache disk(folder);  // a new one: as in another process
  return run_graph(g, {.demand = {.ports = {{1, 0}}}, .disk = &disk, .check_cache = check});
}

std::string verdicts(const RunResult& r) {
  std::string text;
  for (const NodeCaching& c : r.caching)
    text += c.node + ": " + std::string(name_of(c.verdict)) + " " + c.from + c.why + " " + c.detail + " " +
            c.kept + "\n";
  return text;
}

TEST(RunCache, SaysOfEveryNodeWhatBecameOfItAndWhy) {
  const TempFolder folder;
  slow::runs = 0;
  const RunResult cold = run_with(two_slow(folder, 1, 2), folder.path());
  EXPECT_EQ(verdicts(cold), "early: miss never_seen  stored\nlate: miss never_seen  stored\n");
  EXPECT_EQ(slow::runs, 2);
  const RunResult warm = run_with(two_slow(folder, 1, 2), folder.path());
  EXPECT_EQ(verdicts(warm), "early: not_needed   \nlate: hit disk  \n");
  EXPECT_EQ(slow::runs, 2);
  EXPECT_EQ((warm.buffers.at({1, 0}).as<Number>()->value), 3);
  EXPECT_EQ(verdicts(run_with(two_slow(folder, 1, 5), folder.path())),
            "early: hit disk  \nlate: miss params_changed add stored\n");
  EXPECT_EQ(slow::runs, 3);
  EXPECT_EQ(verdicts(run_with(two_slow(folder, 4, 5), folder.path())),
            "early: miss params_changed add stored\nlate: miss input_changed number stored\n");
  fs::remove_all(folder.path() + "/objects");
  EXPECT_EQ(verdicts(run_with(two_slow(folder, 4, 5), folder.path())),
            "early: miss removed evicted, or found damaged stored\n"
            "late: miss removed evicted, or found damaged stored\n");
}

TEST(RunCache, WhatNodesSaidIsSaidAgainWhenTheyAreNotRun) {
  const TempFolder folder;
  const RunResult cold = run_with(two_slow(folder, 1, 2, true), folder.path());
  slow::runs = 0;
  const RunResult warm = run_with(two_slow(folder, 1, 2, true), folder.path());
  EXPECT_EQ(slow::runs, 0);
  EXPECT_EQ(to_text(warm.problems), to_text(cold.problems));
  EXPECT_THAT(to_text(warm.problems), HasSubstr("this took long"));
  ASSERT_TRUE(warm.culprit && cold.culprit);
  EXPECT_EQ(warm.culprit->node, "early");
  EXPECT_EQ(warm.culprit->where, cold.culprit->where);
}

TEST(RunCache, CheckRunsEverythingAndNamesTheNodeThatDiffers) {
  const TempFolder folder;
  const Graph g = two_slow(folder, 1, 2);
  run_with(g, folder.path());
  slow::runs = 0;
  const RunResult same = run_with(g, folder.path(), true);
  EXPECT_EQ(slow::runs, 2);
  EXPECT_FALSE(same.cache_differs);
  EXPECT_EQ(verdicts(same), "early: hit disk  same\nlate: hit disk  same\n");
  {
    DiskCache disk(folder.path());
    const Digest late = disk_key(output_key(node_keys(g)[1], 0));
    disk.remove(late);
    ASSERT_EQ(disk.store(late, std::make_shared<const Number>(Number{17})), DiskCache::Store::stored);
  }
  EXPECT_EQ((run_with(g, folder.path()).buffers.at({1, 0}).as<Number>()->value), 17) << "the lie is believed";
  const RunResult lie = run_with(g, folder.path(), true);
  EXPECT_TRUE(lie.cache_differs);
  EXPECT_THAT(to_text(lie.problems), HasSubstr("late.number: the cache held other bytes"));
  EXPECT_EQ((lie.buffers.at({1, 0}).as<Number>()->value), 3);
  EXPECT_EQ((run_with(g, folder.path()).buffers.at({1, 0}).as<Number>()->value), 3) << "and was removed";
}

TEST(RunCache, WhatIsQuickToMakeIsNotStored) {
  // A thread that the system takes off its processor is not quick: one run of several is enough.
  bool cheap = false;
  for (int attempt = 0; attempt < 20 && !cheap; ++attempt) {
    const TempFolder folder;
    GraphMaker g;
    g.add("quick", "test.number", {});
    g.graph.file = folder.file("graph.json");
    DiskCache disk(folder.path());
    const RunResult r = run_graph(g.graph, {.demand = {.ports = {{0, 0}}}, .disk = &disk});
    cheap = verdicts(r) == "quick: miss never_seen  cheap\n";
    if (!cheap) continue;
    for (const auto& e : fs::recursive_directory_iterator(folder.path() + "/objects"))
      EXPECT_FALSE(e.is_regular_file()) << e.path();
  }
  EXPECT_TRUE(cheap);
}

TEST(RunCache, AnIndexThatIsNoneExplainsNothingAndHarmsNothing) {
  const TempFolder folder;
  const Graph g = two_slow(folder, 1, 2);
  run_with(g, folder.path());
  for (const auto& e : fs::directory_iterator(folder.path() + "/graphs"))
    std::ofstream(e.path(), std::ios::binary) << "{\"format\": [[[";
  EXPECT_EQ(verdicts(run_with(two_slow(folder, 1, 3), folder.path())),
            "early: hit disk  \nlate: miss never_seen  stored\n");
}

}  // namespace
}  // namespace frustum::test
