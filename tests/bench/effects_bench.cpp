// What an effect costs where it is on: the numbers that EffectCost states. One graph that does not call for the effect runs
// in one thread, as planned and forced in turns; the counter ns_per_item is the least time of the forced runs less the least
// of the planned ones, over the effect's items as the plan counts them. Least times scatter less than medians: what else
// uses caches and memory only adds to them.
//
// estimate/... then holds the plan's estimate against a measured saving: a graph of the gallery as planned and with
// everything forced; the counter ratio is what the plan says over what was saved.
#include "runtime/app/effects/plan_effects.h"
#include "runtime/app/effects/prove.h"
#include "runtime/app/files.h"

#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <string>

namespace frustum {
namespace {

// A ball that fills the picture: most of what a plan counts is there.
std::string graph(const std::string& mesh, const std::string& projection, int samples,
                  const std::string& filter, const std::string& interpolation = "phong",
                  const std::string& eye = "[0, 0, 1.6]") {
  return R"({ "format": "frustum.graph/1", "nodes": {
    "mesh": )" +
         mesh + R"(,
    "camera": { "type": "scene.camera", "params": { "eye": )" +
         eye + R"(, "height": 1.3, "resolution": [960, 540] } },
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
const std::string fine_sheet =
    R"({ "type": "mesh.grid", "params": { "size": [1.4, 1], "segments": [256, 256] } })";

// A flat sheet, all of it in the picture, and a texture whose texels are larger than pixels everywhere.
std::string textured_sheet() {
  std::string text = graph(R"({ "type": "mesh.grid", "params": { "size": [1.4, 1] } },
    "tiles": { "type": "io.load_image", "params": { "file": "graphs/data/card.png" } },
    "texture": { "type": "texture.image", "in": { "image": "tiles" } })",
                           "project.perspective", 4, "mitchell", "phong", "[0, 1.4, 0.6]");
  const std::string plain = R"("points": "points", "mesh": "screen" } },
    "lit")";
  return text.replace(text.find(plain), plain.size(),
                      R"("points": "points", "mesh": "screen", "texture": "texture" } },
    "lit")");
}

// Every fragment of the picture by an A-buffer: `mesh`, of which nothing hides another part, seen from above.
std::string layered(const std::string& mesh, const std::string& opacity) {
  return R"({ "format": "frustum.graph/1", "nodes": {
    "made": )" +
         mesh + R"(,
    "mesh": { "type": "shade.transparency", "in": { "mesh": "made" }, "params": { "opacity": )" +
         opacity + R"( } },
    "camera": { "type": "scene.camera", "params": { "eye": [0, 1.4, 0.6], "resolution": [960, 540] } },
    "light": { "type": "light.ambient" },
    "eye": { "type": "project.view", "in": { "mesh": "mesh", "camera": "camera" } },
    "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "cut": { "type": "clip.homogeneous", "in": { "mesh": "clip" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "cut", "camera": "camera" } },
    "pattern": { "type": "supersample.pattern", "params": { "samples": 4 } },
    "lists": { "type": "visibility.abuffer", "in": { "mesh": "screen", "pattern": "pattern" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "lists", "mesh": "screen" } },
    "lit": { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "lights": ["light"] },
             "params": { "interpolation": "flat", "two_sided": true } },
    "through": { "type": "visibility.composite", "in": { "image": "lit", "pattern": "pattern" } } },
  "outputs": { "image": { "from": "through" } } })";
}

// A ball whose back faces are culled.
std::string culled_ball() {
  std::string text = graph(ball, "project.perspective", 1, "box");
  const std::string cut = R"("mesh": "cut", "camera": "camera" } },)";
  const std::string front = R"("mesh": "front", "camera": "camera" } },
    "front": { "type": "cull.backface", "in": { "mesh": "cut" } },)";
  return text.replace(text.find(cut), cut.size(), front);
}

// Time of the processor, not of the clock: what else runs on the machine takes its turn and is not counted. No thread but
// one runs.
double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double seconds_of(Session& session, const Graph& g, const Demand& demand, const EffectPolicy& policy) {
  RunOptions o{.demand = demand, .threads = 1};
  o.effects = policy;
  const double began = cpu_seconds();
  session.run(g, o, false);
  return cpu_seconds() - began;
}

struct Setting {
  const char* effect;
  std::string text;
  const char* want = "";  // empty: the picture; effects of geometry are measured without pixels
};

void forced_against_planned(benchmark::State& state, const Setting& setting) {
  Session session;
  const Loaded loaded =
      load_graph_text(setting.text, (source_root(executable_path()).value_or(".") / "bench.json").string(),
                      session.registry());
  if (!loaded.graph) return state.SkipWithError(to_text(loaded.problems).c_str());
  const Graph& g = *loaded.graph;
  const Demand demand{.ports = *setting.want != 0 ? std::vector{*g.find_port(setting.want)} : named_ports(g)};
  double items = 0;
  for (const PlannedEffect& e : plan_effects(session, g, demand).effects)
    if (e.effect == setting.effect && e.verdict &&
        (e.verdict->kind == Verdict::Kind::off_exact || e.verdict->kind == Verdict::Kind::off_user))
      items += static_cast<double>(e.verdict->items) *
               e.share;  // as the plan counts them, at all nodes that have it
  if (items == 0) return state.SkipWithError("the scene calls for it");
  double least_planned = 1e9, least_forced = 1e9;
  for (auto _ : state) {
    const double planned = seconds_of(session, g, demand, {}),
                 forced = seconds_of(session, g, demand, {.forced = {setting.effect}});
    least_planned = std::min(least_planned, planned), least_forced = std::min(least_forced, forced);
    state.SetIterationTime(std::max(0.0, forced - planned));
  }
  state.counters["ns_per_item"] = 1e9 * (least_forced - least_planned) / items;
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
  double least_planned = 1e9, least_forced = 1e9;
  for (auto _ : state) {
    const double planned = seconds_of(session, g, demand, {}),
                 forced = seconds_of(session, g, demand, {.force_all = true});
    least_planned = std::min(least_planned, planned), least_forced = std::min(least_forced, forced);
    state.SetIterationTime(std::max(0.0, forced - planned));
  }
  const double saved = least_forced - least_planned;
  state.counters["estimate_ms"] = 1e3 * estimate;
  state.counters["saved_ms"] = 1e3 * saved;
  state.counters["ratio"] = estimate / saved;
}

void add(const Setting& setting) {
  benchmark::RegisterBenchmark((std::string("effect/") + setting.effect).c_str(),
                               [setting](benchmark::State& s) { forced_against_planned(s, setting); })
      ->UseManualTime()
      ->Unit(benchmark::kMillisecond)
      ->Iterations(31);
}

const bool registered = [] {
  const std::string perspective = "project.perspective", parallel = "project.orthographic", wide = "mitchell";
  for (const char* effect :
       {"highlights", "ambient_light", "attenuation", "two_sided_lighting", "texture_lookup"})
    add({effect, graph(ball, perspective, 4, wide), "lit.color"});
  for (const char* effect : {"color_conversion", "unread_planes"})
    add({effect, graph(ball, perspective, 4, wide)});
  add({"blank_pixels", graph(ball, perspective, 4, wide, "phong", "[0, 0, 9]")});
  add({"clipping", graph(ball, perspective, 1, wide, "phong", "[0, 0, 9]"), "cut.mesh"});
  add({"outside_faces", graph(ball, perspective, 1, wide), "screen.mesh"});
  add({"perspective_divide", graph(ball, parallel, 1, wide), "screen.mesh"});
  add({"perspective_interpolation", graph(ball, parallel, 4, wide), "points.points"});
  add({"normal_interpolation", graph(box, perspective, 4, wide), "points.points"});
  add({"reconstruction", graph(ball, perspective, 1, "box")});
  add({"supersampling", graph(box, perspective, 4, wide, "flat"), "lit.color"});
  add({"mip_levels", textured_sheet(), "albedo.image"});
  add({"transparency", layered(fine_sheet, "1")});
  add({"hidden_by_opaque", layered(fine_sheet, "0.5"), "lists.layers"});
  add({"back_faces", culled_ball(), "hits.visibility"});
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
