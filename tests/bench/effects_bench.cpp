// What an effect costs where it is on: the numbers that EffectCost states. One graph that does not call for the effect runs
// in one thread, as planned and forced in turns; the time of an iteration is the difference, and the counter ns_per_item is
// its median over the effect's items as the plan counts them.
#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/effects/prove.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>

namespace frustum {
namespace {

// A ball that fills the picture: most of what a plan counts is there.
std::string graph(const std::string& mesh, const std::string& projection, int samples,
                  const std::string& filter) {
  return R"({ "format": "frustum.graph/1", "nodes": {
    "mesh": )" +
         mesh + R"(,
    "camera": { "type": "scene.camera", "params": { "eye": [0, 0, 1.6], "height": 1.3, "resolution": [960, 540] } },
    "light": { "type": "light.point", "params": { "position": [2, 3, 4] } },
    "eye": { "type": "project.view", "in": { "mesh": "mesh", "camera": "camera" } },
    "clip": { "type": ")" +
         projection + R"(", "in": { "mesh": "eye", "camera": "camera" } },
    "near": { "type": "cull.frustum", "in": { "mesh": "clip" } },
    "cut": { "type": "clip.homogeneous", "in": { "mesh": "near" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "cut", "camera": "camera" } },
    "pattern": { "type": "supersample.pattern", "params": { "samples": )" +
         std::to_string(samples) + R"( } },
    "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen", "pattern": "pattern" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "albedo": { "type": "texture.sample", "in": { "points": "points", "mesh": "screen" } },
    "lit": { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "albedo": "albedo", "lights": ["light"] } },
    "pixels": { "type": "supersample.resolve", "in": { "image": "lit" }, "params": { "filter": ")" +
         filter + R"(" } },
    "display": { "type": "color.convert", "in": { "image": "pixels" }, "params": { "to": "lin_rec709" } } },
  "outputs": { "image": { "from": "display" } } })";
}

const std::string ball = R"({ "type": "mesh.sphere", "params": { "segments": 512, "rings": 256 } })";
const std::string box = R"({ "type": "mesh.box", "params": { "size": [2, 2, 1] } })";

struct Setting {
  const char* effect;
  std::string text;
};

void forced_against_planned(benchmark::State& state, const Setting& setting) {
  Session session;
  const Loaded loaded = load_graph_text(setting.text, "bench.json", session.registry());
  if (!loaded.graph) return state.SkipWithError(to_text(loaded.problems).c_str());
  const Graph& g = *loaded.graph;
  const Demand demand{.ports = named_ports(g)};
  std::uint64_t items = 0;
  for (const PlannedEffect& e : plan_effects(session, g, demand).effects)
    if (e.effect == setting.effect && e.verdict && e.verdict->kind == Verdict::Kind::off_exact)
      items = e.verdict->items;
  if (items == 0) return state.SkipWithError("the scene calls for it");
  const auto seconds = [&](const EffectPolicy& policy) {
    RunOptions o{.demand = demand, .threads = 1};
    o.effects = policy;
    const auto began = std::chrono::steady_clock::now();
    session.run(g, o, false);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  std::vector<double> more;
  for (auto _ : state) {
    const double planned = seconds({}), forced = seconds({.forced = {setting.effect}});
    more.push_back(forced - planned);
    state.SetIterationTime(std::max(0.0, forced - planned));
  }
  std::nth_element(more.begin(), more.begin() + static_cast<std::ptrdiff_t>(more.size() / 2), more.end());
  state.counters["ns_per_item"] = 1e9 * more[more.size() / 2] / static_cast<double>(items);
}

void add(const Setting& setting) {
  benchmark::RegisterBenchmark((std::string("effect/") + setting.effect).c_str(),
                               [setting](benchmark::State& s) { forced_against_planned(s, setting); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(15);
}

const bool registered = [] {
  const std::string perspective = "project.perspective", parallel = "project.orthographic", wide = "mitchell";
  for (const char* effect : {"clipping", "highlights", "ambient_light", "attenuation", "two_sided_lighting",
                             "texture_lookup", "color_conversion", "outside_faces"})
    add({effect, graph(ball, perspective, 4, wide)});
  add({"perspective_divide", graph(ball, parallel, 4, wide)});
  add({"perspective_interpolation", graph(ball, parallel, 4, wide)});
  add({"normal_interpolation", graph(box, perspective, 4, wide)});
  add({"reconstruction", graph(ball, perspective, 1, "box")});
  return true;
}();

}  // namespace
}  // namespace frustum
