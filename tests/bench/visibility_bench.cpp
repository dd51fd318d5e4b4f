// Algorithms of visibility beside the tiled z-buffer, at 1920 x 1080 with one sample a pixel, on the scenes of
// frame_scenes.h. What is reported is the least time of each and their ratio, taken in turns in one process.
#include "nodes/all_nodes.h"
#include "nodes/kernels/space_partition.h"
#include "runtime/buffers/screen_view.h"
#include "tests/bench/frame_scenes.h"
#include "tests/bench/graph_of.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <stdexcept>

namespace frustum {
namespace {

using bench::graph_of, bench::height, bench::result_of, bench::width;

struct Inputs {};
struct Params {};
struct Scene {
  Ref<Mesh> mesh;
};
Ref<Mesh> current_mesh;
Scene scene(const Inputs&, const Params&, Context&) { return {current_mesh}; }

Registry nodes_and(Space space) {
  std::vector<NodeType> types = all_node_types();
  types.push_back(node("bench.scene", scene).output("mesh", &Scene::mesh, "A scene.", {.space = space}));
  return Registry(std::move(types));
}

Ref<Mesh> on_screen(const bench::FrameScene& of) {
  current_mesh = of.mesh;
  return result_of(graph_of(fmt::format(R"({{ "format": "frustum.graph/1", "nodes": {{
    "scene":  {{ "type": "bench.scene" }},
    "camera": {{ "type": "scene.camera", "params": {{ "eye": [{}, {}, {}], "target": [0, 0, 0], "fov_y": {},
                "near": {}, "far": {}, "resolution": [{}, {}] }} }},
    "eye":    {{ "type": "project.view", "in": {{ "mesh": "scene", "camera": "camera" }} }},
    "clip":   {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
    "cut":    {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
    "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }} }} }})",
                                        of.eye.x, of.eye.y, of.eye.z, bench::fov_y_deg, bench::near_z,
                                        bench::far_z, width, height),
                            nodes_and(Space::world)))
      .as<Mesh>();
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// `algorithm` from a mesh on the screen to a whole buffer of ids and depths, beside rasterize.triangles.
void beside_tiles(benchmark::State& state, bench::FrameScene (*make)(), std::string_view algorithm) {
  current_mesh = on_screen(make());
  const Registry registry = nodes_and(Space::screen);
  const auto graph = [&](std::string_view type) {
    return graph_of(fmt::format(R"({{ "format": "frustum.graph/1", "nodes": {{
      "screen": {{ "type": "bench.scene" }}, "hits": {{ "type": "{}", "in": {{ "mesh": "screen" }} }} }} }})",
                                type),
                    registry);
  };
  const Graph one = graph(algorithm), tiles = graph("rasterize.triangles");
  const auto time = [](const Graph& g) {
    return seconds_of([&] { benchmark::DoNotOptimize(result_of(g)); });
  };
  time(one), time(tiles);
  double best = 1e9, best_tiles = 1e9;
  for (auto _ : state) {
    const double s = time(one);
    state.SetIterationTime(s);
    best = std::min(best, s), best_tiles = std::min(best_tiles, time(tiles));
  }
  state.counters["ms"] = 1e3 * best;
  state.counters["tiles_ms"] = 1e3 * best_tiles;
  state.counters["ratio"] = best / best_tiles;
}

void add_scanline(const std::string& name, bench::FrameScene (*make)()) {
  benchmark::RegisterBenchmark(
      ("visibility.scanline/" + name).c_str(),
      [=](benchmark::State& state) { beside_tiles(state, make, "visibility.scanline"); })
      ->UseManualTime()
      ->Iterations(9)
      ->Unit(benchmark::kMillisecond);
}

// The tree alone, in one thread: how long it takes, and how often it splits a face.
void build_tree(benchmark::State& state, bsp::Splitter splitter) {
  const Ref<Mesh> mesh = on_screen(bench::torus(316, 158));
  const ScreenView<float> view(mesh);
  const auto faces = kernels::screen_faces(view.triangles(), 1.0F);
  std::uint64_t splits = 0, went_in = 1, depth = 0;
  for (auto _ : state) {
    const bsp::Tree tree = bsp::build(faces, {0, 0, width, height}, {.splitter = splitter}, {});
    splits = tree.splits, went_in = tree.faces, depth = tree.depth;
  }
  state.counters["faces"] = static_cast<double>(went_in);
  state.counters["splits_per_face"] = static_cast<double>(splits) / static_cast<double>(went_in);
  state.counters["depth"] = static_cast<double>(depth);
}

const int registered = [] {
  add_scanline("1k_triangles", [] { return bench::torus(32, 16); });
  add_scanline("100k_triangles", [] { return bench::torus(316, 158); });
  add_scanline("1M_triangles", [] { return bench::torus(1000, 500); });
  add_scanline("soup_100k_triangles", bench::soup);
  add_scanline("8_layers", bench::layers);
  return 0;
}();

BENCHMARK_CAPTURE(build_tree, least_splits, bsp::Splitter::least_splits)
    ->Name("visibility.bsp/100k_triangles/least_splits")
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(build_tree, balanced, bsp::Splitter::balanced)
    ->Name("visibility.bsp/100k_triangles/balanced")
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace frustum
