// Sixteen screens of triangles behind one another at 1920 x 1080, one sample a pixel: opaque through the z-buffer, in
// turns with half transparent ones through the A-buffer. Both are shaded by Phong with a Blinn highlight under two
// lights; what is reported is the least time of each and their ratio: times drift, the ratio of turns does not.
#include "nodes/all_nodes.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "tests/bench/graph_of.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>

namespace frustum {
namespace {

constexpr int width = 1920, height = 1080, layers = 16, columns = 40, rows = 24;

// Wavy sheets across the whole view, the nearest first or last or between, each of two triangles a cell.
Ref<Mesh> make_sheets() {
  constexpr std::size_t per_sheet = (columns + 1) * (rows + 1);
  auto position = Column::make<glm::vec3>("position", Domain::vertex, per_sheet * layers, Space::world);
  auto normal = Column::make<glm::vec3>("normal", Domain::vertex, per_sheet * layers, Space::world);
  auto face = Column::make<glm::uvec3>("triangle", Domain::face, std::size_t{2} * columns * rows * layers);
  std::size_t v = 0, f = 0;
  for (int layer = 0; layer < layers; ++layer) {
    const float z = -5.0F - 0.5F * static_cast<float>(layer * 7 % layers);  // in no order of depth
    const auto first = static_cast<std::uint32_t>(v);
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= columns; ++i, ++v) {
        const float x = static_cast<float>(i) / columns - 0.5F, y = static_cast<float>(j) / rows - 0.5F;
        position->values<glm::vec3>()[v] = {40 * x, 24 * y, z + 0.4F * x * y};
        normal->values<glm::vec3>()[v] = {0.6F * x, 0.6F * y, 0.9F};
      }
    for (std::uint32_t j = 0; j < rows; ++j)
      for (std::uint32_t i = 0; i < columns; ++i) {
        const std::uint32_t a = first + j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
        face->values<glm::uvec3>()[f++] = {a, b, d};
        face->values<glm::uvec3>()[f++] = {a, d, c};
      }
  }
  Mesh mesh;
  mesh.columns = {face, position, normal};
  return std::make_shared<const Mesh>(std::move(mesh));
}

struct Inputs {};
struct Params {};
struct Sheets {
  Ref<Mesh> mesh;
};
Sheets sheets(const Inputs&, const Params&, Context&) {
  static const Ref<Mesh> kept = make_sheets();
  return {kept};
}

Registry nodes_and_sheets() {
  std::vector<NodeType> types = all_node_types();
  types.push_back(
      node("bench.sheets", sheets).output("mesh", &Sheets::mesh, "Sheets.", {.space = Space::world}));
  return Registry(std::move(types));
}

Graph graph_of(const Registry& registry, double opacity, std::string_view visibility, std::string_view last) {
  const std::string text = fmt::format(R"({{
  "format": "frustum.graph/1",
  "nodes": {{
    "scene":  {{ "type": "bench.sheets" }},
    "camera": {{ "type": "scene.camera", "params": {{ "eye": [0, 0, 0], "target": [0, 0, -1], "fov_y": 60, "near": 1, "far": 40,
                "resolution": [{}, {}] }} }},
    "key":    {{ "type": "light.directional", "params": {{ "direction": [-1, -1, -2] }} }},
    "fill":   {{ "type": "light.ambient", "params": {{ "color": [0.125, 0.125, 0.125] }} }},
    "glass":  {{ "type": "shade.material", "params": {{ "diffuse": 0.6, "specular": 0.3, "shininess": 32 }} }},
    "clear":  {{ "type": "shade.transparency", "in": {{ "mesh": "scene" }}, "params": {{ "opacity": {} }} }},
    "eye":    {{ "type": "project.view", "in": {{ "mesh": "clear", "camera": "camera" }} }},
    "clip":   {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
    "cut":    {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
    "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }},
    "hits":   {{ {} }},
    "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }} }},
    "lit":    {{ "type": "shade.surface", "in": {{ "points": "points", "mesh": "screen", "material": "glass",
                "lights": ["key", "fill"], "camera": "camera" }} }}{} }} }})",
                                       width, height, opacity, visibility, last);
  return bench::graph_of(text, registry);
}

double seconds_of(const Graph& graph, Buffer& image) {
  const auto start = std::chrono::steady_clock::now();
  image = bench::result_of(graph);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double mean_alpha(const Buffer& image) {
  const Raster& r = image.as<Image>()->raster;
  const int alpha = r.frame().find("A").value();
  double sum = 0;
  for (int y = 0; y < height; y += 8)
    for (int x = 0; x < width; x += 8) sum += r.value(alpha, 0, x, y);
  return sum / (height / 8.0) / (width / 8.0);
}

void sixteen_layers(benchmark::State& state) {
  const Registry registry = nodes_and_sheets();
  const Graph opaque =
      graph_of(registry, 1, R"("type": "rasterize.triangles", "in": { "mesh": "screen" })", "");
  const Graph clear =
      graph_of(registry, 0.25, R"("type": "visibility.abuffer", "in": { "mesh": "screen" })",
               R"(, "through": { "type": "visibility.composite", "in": { "image": "lit" } })");
  Buffer seen, through;
  seconds_of(opaque, seen), seconds_of(clear, through);
  double best = 1e9, best_opaque = 1e9;
  for (auto _ : state) {
    const double s = seconds_of(clear, through);
    state.SetIterationTime(s);
    best = std::min(best, s);
    best_opaque = std::min(best_opaque, seconds_of(opaque, seen));
  }
  state.counters["abuffer_ms"] = 1e3 * best;
  state.counters["opaque_ms"] = 1e3 * best_opaque;
  state.counters["ratio"] = best / best_opaque;
  state.counters["mean_alpha"] = mean_alpha(through);  // 1 - 0.75^16 = 0.98998
  state.counters["mean_alpha_opaque"] = mean_alpha(seen);
}
BENCHMARK(sixteen_layers)
    ->Name("abuffer/16_layers_1080p_phong")
    ->UseManualTime()
    ->Iterations(7)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace frustum
