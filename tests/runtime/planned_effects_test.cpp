// What a run is asked of effects, and what it says of them.
#include "runtime/app/session.h"
#include "runtime/graph/keys.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

// A box wholly in view, one sample a pixel.
constexpr auto box = R"({ "format": "frustum.graph/1", "nodes": {
    "box": { "type": "mesh.box" },
    "camera": { "type": "scene.camera", "params": { "eye": [6, 4, 8], "resolution": [32, 24] } },
    "eye": { "type": "project.view", "in": { "mesh": "box", "camera": "camera" } },
    "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "cut": { "type": "clip.homogeneous", "in": { "mesh": "clip" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "cut", "camera": "camera" } },
    "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "facts": { "type": "check.statistics", "in": { "image": "points" } } } })";

Graph load(const char* text) {
  static const Session session;
  Loaded loaded = load_graph_text(text, "g.json", session.registry());
  if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  return std::move(*loaded.graph);
}

const Verdict* verdict(const RunResult& r, std::string_view node) {
  for (const NodeVerdict& v : r.verdicts)
    if (v.node == node) return &v.verdict;
  return nullptr;
}

TEST(PlannedEffects, ARunSaysWhatItsNodesDecided) {
  const Graph g = load(box);
  const RunResult r = run_graph(g, {.demand = {.ports = end_ports(g)}});
  ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
  ASSERT_NE(verdict(r, "cut"), nullptr);
  EXPECT_EQ(verdict(r, "cut")->kind, Verdict::Kind::off_exact);
  EXPECT_EQ(verdict(r, "screen")->kind, Verdict::Kind::on);
}

TEST(PlannedEffects, SkippingReachesTheNodes) {
  const Graph g = load(box);
  RunOptions o{.demand = {.ports = end_ports(g)}};
  o.effects.skipped = {"perspective_divide"};
  const RunResult r = run_graph(g, o);
  ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
  EXPECT_EQ(verdict(r, "screen")->kind, Verdict::Kind::off_user);
  const RunResult planned = run_graph(g, {.demand = {.ports = end_ports(g)}});
  EXPECT_NE(r.buffers.begin()->second.digest(), planned.buffers.begin()->second.digest());
}

TEST(PlannedEffects, OnlyFactsFillsNoPixel) {
  const Graph g = load(box);
  struct Watch : Observer {
    std::vector<std::string> done_nodes;
    int pixels = 0;
    void done(const WorkDone& w) override {
      pixels += w.kind == WorkDone::Kind::pixels ? 1 : 0;
      done_nodes.insert(done_nodes.end(), w.nodes.begin(), w.nodes.end());
    }
  } watch;
  const RunResult r =
      run_graph(g, {.demand = {.ports = end_ports(g)}, .observer = &watch, .only_facts = true});
  EXPECT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
  EXPECT_EQ(watch.pixels, 0);
  EXPECT_TRUE(r.buffers.empty());
  EXPECT_EQ(std::count(watch.done_nodes.begin(), watch.done_nodes.end(), "hits"), 1);
  EXPECT_EQ(std::count(watch.done_nodes.begin(), watch.done_nodes.end(), "facts"), 0);
  EXPECT_NE(verdict(r, "cut"), nullptr);
}

TEST(PlannedEffects, WhatIsAskedOfEffectsIsInTheKeysOfTheNodesThatHaveThem) {
  const Graph g = load(box);
  const auto plain = node_keys(g);
  EffectPolicy clipping;
  clipping.forced = {"clipping"};
  const auto forced = node_keys(g, clipping);
  clipping.forced = {}, clipping.skipped = {"clipping"};
  const auto skipped = node_keys(g, clipping);
  for (std::size_t i = 0; i < g.nodes.size(); ++i) {
    const std::string& id = g.nodes[i].id;
    const bool follows = id == "cut" || id == "screen" || id == "hits" || id == "points" || id == "facts";
    EXPECT_EQ(plain[i] != forced[i], follows) << id;
    EXPECT_EQ(forced[i] != skipped[i], follows) << id;
  }
}

}  // namespace
}  // namespace frustum
