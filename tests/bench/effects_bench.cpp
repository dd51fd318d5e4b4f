// What an effect costs where it is on: the numbers that EffectCost states. One graph that does not call for the effect runs
// in one thread, as planned and forced in turns; the time of an iteration is the difference, and the counter ns_per_item is
// its median over the effect's items as the plan counts them.
//
// estimate/... then holds the plan's estimate against a measured saving: a graph of the gallery as planned and with
// everything forced; the counter ratio is what the plan says over what was saved.
#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/effects/prove.h"
#include "runtime/app/files.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>

namespace frustum {
namespace {

// A ball that fills the picture: most of what a plan counts is there.
std::string graph(const std::string& mesh, const std::string& projection, int samples,
                  const std::string& filter, const std::string& interpolation = "phong") {
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
    "lit": { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "albedo": "albedo", "lights": ["light"] },
      "params": { "interpolation": ")" +
         interpolation + R"(" } },
    "pixels": { "type": "supersample.resolve", "in": { "image": "lit" }, "params": { "filter": ")" +
         filter + R"(" } },
    "display": { "type": "color.convert", "in": { "image": "pixels" }, "params": { "to": "lin_rec709" } } },
  "outputs": { "image": { "from": "display" } } })";
}

const std::string ball = R"({ "type": "mesh.sphere", "params": { "segments": 512, "rings": 256 } })";
const std::string box = R"({ "type": "mesh.box", "params": { "size": [2, 2, 1] } })";

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double seconds_of(Session& session, const Graph& g, const Demand& demand, const EffectPolicy& policy) {
  RunOptions o{.demand = demand, .threads = 1};
  o.effects = policy;
  const auto began = std::chrono::steady_clock::now();
  session.run(g, o, false);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

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
  std::vector<double> more;
  for (auto _ : state) {
    const double planned = seconds_of(session, g, demand, {}),
                 forced = seconds_of(session, g, demand, {.forced = {setting.effect}});
    more.push_back(forced - planned);
    state.SetIterationTime(std::max(0.0, forced - planned));
  }
  state.counters["ns_per_item"] = 1e9 * median_of(more) / static_cast<double>(items);
}

void estimate_against_saving(benchmark::State& state, const std::string& file) {
  Session session;
  LoadOptions options;
  options.settings = {{"resolution", "[640,360]"}};
  const Loaded loaded = session.load(
      (source_root(executable_path()).value_or(".") / "graphs/gallery" / file).string(), options);
  if (!loaded.graph) return state.SkipWithError(to_text(loaded.problems).c_str());
  const Graph& g = *loaded.graph;
  Demand demand;
  for (const OutputLayer& l : g.outputs.front().layers) demand.ports.push_back(l.from);
  const double estimate =
      std::chrono::duration<double>(plan_effects(session, g, demand).estimate(Verdict::Kind::off_exact))
          .count();
  std::vector<double> more;
  for (auto _ : state) {
    const double planned = seconds_of(session, g, demand, {}),
                 forced = seconds_of(session, g, demand, {.force_all = true});
    more.push_back(forced - planned);
    state.SetIterationTime(std::max(0.0, forced - planned));
  }
  state.counters["estimate_ms"] = 1e3 * estimate;
  state.counters["saved_ms"] = 1e3 * median_of(more);
  state.counters["ratio"] = estimate / median_of(more);
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
                             "texture_lookup", "color_conversion", "outside_faces", "unread_planes"})
    add({effect, graph(ball, perspective, 4, wide)});
  add({"perspective_divide", graph(ball, parallel, 4, wide)});
  add({"perspective_interpolation", graph(ball, parallel, 4, wide)});
  add({"normal_interpolation", graph(box, perspective, 4, wide)});
  add({"reconstruction", graph(ball, perspective, 1, "box")});
  add({"supersampling", graph(ball, perspective, 4, wide, "flat")});
  for (const char* file : {"teapot_plaster.json", "teapot.json", "near_plane.json"})
    benchmark::RegisterBenchmark((std::string("estimate/") + file).c_str(),
                                 [file](benchmark::State& s) { estimate_against_saving(s, file); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond)
        ->Iterations(9);
  return true;
}();

}  // namespace
}  // namespace frustum
