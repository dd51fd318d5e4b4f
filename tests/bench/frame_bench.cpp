// Whole frames at 1920 x 1080, in turns with Mesa's llvmpipe: Phong shading with a Blinn highlight, a mipmapped
// 1024 x 1024 texture with trilinear filter, 32-bit depth. Both keep the mesh and the texture in memory and start
// from world space, frustum with numbers of 16 bits in its texels and llvmpipe with 8; frustum also publishes the
// linear float image. What is reported is the least time of each and their ratio: times drift, the ratio of turns
// does not. Two differences: frustum shades each pixel (with four samples, each face of a pixel) once and after
// visibility is known, llvmpipe as the triangles come; and ids and depths are compared in a frame of their own,
// where llvmpipe writes the number of the triangle.
#include "nodes/all_nodes.h"
#include "nodes/kernels/camera.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/texture.h"
#include "tests/bench/frame_scenes.h"
#include "tests/bench/graph_of.h"
#include "tests/bench/llvmpipe.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace frustum {
namespace {

using bench::far_z, bench::fov_y_deg, bench::graph_of, bench::height, bench::near_z, bench::result_of,
    bench::width;
constexpr int texture_edge = 1024;
constexpr glm::dvec3 light_direction{-0.4, -0.7, -0.6};

// 8 x 8 squares of 0.75 and 0.25, which 191 and 64 of 255 come nearest to.
bool is_bright(int x, int y) { return (x / (texture_edge / 8) + y / (texture_edge / 8)) % 2 == 0; }

Ref<Image> make_board() {
  Raster raster({.window = {0, 0, texture_edge, texture_edge},
                 .planes = {{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}},
                 .color_space = std::string(linear_rec709)});
  for (int plane = 0; plane < 3; ++plane)
    for (int y = 0; y < texture_edge; ++y)
      for (int x = 0; x < texture_edge; ++x)
        raster.view().row<float>(plane, 0, y)[x] = is_bright(x, y) ? 0.75f : 0.25f;
  return std::make_shared<const Image>(Image{std::move(raster)});
}

struct Inputs {};
struct Params {};
struct Board {
  Ref<Image> image;
};
struct Scene {
  Ref<Mesh> mesh;
  Ref<Texture> texture;
};

Board board(const Inputs&, const Params&, Context&) { return {make_board()}; }

// Made once: no frame holds the making of the pyramid.
Ref<Texture> kept_texture() {
  static const Ref<Texture> kept = [] {
    std::vector<NodeType> types = all_node_types();
    types.push_back(node("bench.board", board).output("image", &Board::image, "A checkerboard."));
    const Registry registry(std::move(types));
    const Graph g = graph_of(R"({ "format": "frustum.graph/1", "nodes": {
      "image": { "type": "bench.board" },
      "texture": { "type": "texture.image", "in": { "image": "image" }, "params": { "storage": "half" } } } })",
                             registry);
    return result_of(g).as<Texture>();
  }();
  return kept;
}

Ref<Mesh> current_mesh;
Scene scene(const Inputs&, const Params&, Context&) { return {current_mesh, kept_texture()}; }

Registry nodes_and_scene() {
  std::vector<NodeType> types = all_node_types();
  types.push_back(node("bench.scene", scene)
                      .output("mesh", &Scene::mesh, "A scene.", {.space = Space::world})
                      .output("texture", &Scene::texture, "A checkerboard."));
  return Registry(std::move(types));
}

// With more than one sample a pixel they are shaded once a pixel and face, and averaged.
Graph frame_graph(const Registry& registry, const bench::FrameScene& of, int samples) {
  constexpr const char* text = R"({{
  "format": "frustum.graph/1",
  "nodes": {{
    "scene":  {{ "type": "bench.scene" }},
    "camera": {{ "type": "scene.camera", "params": {{ "eye": [{eye}], "target": [0, 0, 0], "fov_y": {fov},
                "near": {near}, "far": {far}, "resolution": [{width}, {height}] }} }},
    "key":    {{ "type": "light.directional", "params": {{ "direction": [{light}] }} }},
    "fill":   {{ "type": "light.ambient", "params": {{ "color": [0.125, 0.125, 0.125] }} }},
    "clay":   {{ "type": "shade.material", "params": {{ "diffuse": 0.8, "specular": 0.3, "shininess": 32 }} }},
    "eye":    {{ "type": "project.view", "in": {{ "mesh": "scene.mesh", "camera": "camera" }} }},
    "clip":   {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
    "cut":    {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
    {culling}
    "screen": {{ "type": "project.viewport", "in": {{ "mesh": "{culled}", "camera": "camera" }} }},
    {pattern}
    "hits":   {{ "type": "rasterize.triangles", "in": {{ "mesh": "screen" {sampled} }} }},
    "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }} }},
    "albedo": {{ "type": "texture.sample", "in": {{ "points": "points", "texture": "scene.texture" }} }},
    "lit":    {{ "type": "shade.surface", "in": {{ "points": "points", "mesh": "screen", "albedo": "albedo",
                "material": "clay", "lights": ["key", "fill"], "camera": "camera" }},
                "params": {{ "rate": "pixel" }} }} {resolved} }} }})";
  const auto three = [](glm::dvec3 v) { return fmt::format("{}, {}, {}", v.x, v.y, v.z); };
  using fmt::operator""_a;
  const std::string pattern = fmt::format(
      R"("pattern": {{ "type": "supersample.pattern", "params": {{ "samples": {}, "kind": "sobol" }} }},)",
      samples);
  const char* resolved =
      R"(, "pixels": { "type": "supersample.resolve", "in": { "image": "lit" }, "params": { "filter": "box" } })";
  return graph_of(
      fmt::format(
          text, "eye"_a = three(of.eye), "fov"_a = fov_y_deg, "near"_a = near_z, "far"_a = far_z,
          "width"_a = width, "height"_a = height, "light"_a = three(light_direction),
          "culling"_a = of.cull ? R"("front": { "type": "cull.backface", "in": { "mesh": "cut" } },)" : "",
          "culled"_a = of.cull ? "front" : "cut", "pattern"_a = samples > 1 ? pattern : "",
          "sampled"_a = samples > 1 ? R"(, "pattern": "pattern")" : "",
          "resolved"_a = samples > 1 ? resolved : ""),
      registry);
}

std::vector<std::uint8_t> peer_texture() {
  std::vector<std::uint8_t> rgba;
  for (int y = 0; y < texture_edge; ++y)
    for (int x = 0; x < texture_edge; ++x) {
      const std::uint8_t level = is_bright(x, y) ? 191 : 64;
      rgba.insert(rgba.end(), {level, level, level, 255});
    }
  return rgba;
}

bench::PeerScene peer_scene(const bench::FrameScene& of, int samples,
                            const std::vector<std::uint8_t>& texture) {
  const auto view = kernels::look_at(of.eye, glm::dvec3{0}, glm::dvec3{0, 1, 0}).eye_from_world;
  const double f = 1 / std::tan(fov_y_deg * std::numbers::pi / 360);
  glm::dmat4 clip_from_eye(0);
  clip_from_eye[0][0] = f * height / width, clip_from_eye[1][1] = f;
  clip_from_eye[2][2] = -(far_z + near_z) / (far_z - near_z), clip_from_eye[2][3] = -1;
  clip_from_eye[3][2] = -2 * far_z * near_z / (far_z - near_z);
  const glm::dvec3 to_light = -light_direction / std::sqrt(glm::dot(light_direction, light_direction));
  return {.position = of.mesh->at("position").values<glm::vec3>(),
          .normal = of.mesh->at("normal").values<glm::vec3>(),
          .uv = of.mesh->at("uv").values<glm::vec2>(),
          .face = of.mesh->triangles(),
          .cull = of.cull,
          .samples = samples,
          .clip_from_world = glm::mat4(clip_from_eye * kernels::matrix_of(view)),
          .eye = glm::vec3(of.eye),
          .to_light = glm::vec3(to_light),
          .width = width,
          .height = height,
          .texture_edge = texture_edge,
          .texture = texture.data()};
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Counts the pixels where the two rasterizers see another triangle, or depths more than 1e-4 apart.
void compare_visibility(const Graph& graph, bench::Llvmpipe& peer, benchmark::State& state) {
  const auto at = [&](std::string_view node) {
    return static_cast<std::size_t>(std::ranges::find(graph.nodes, node, &GraphNode::id) -
                                    graph.nodes.begin());
  };
  const PortRef hits{at("hits"), 0}, screen{at("screen"), 0};
  RunOptions options;
  options.demand.ports = {hits, screen};
  const RunResult result = run_graph(graph, options);
  if (result.end != RunResult::End::done) throw std::runtime_error(to_text(result.problems));
  const Raster& seen = result.buffers.at(hits).as<Visibility>()->raster;
  const Column* origin = result.buffers.at(screen).as<Mesh>()->find("origin");
  const int id = seen.frame().find("id").value(), z = seen.frame().find("Z").value();
  const bench::PeerVisibility theirs = peer.visibility();
  double covered = 0, their_covered = 0, other_id = 0, other_depth = 0;
  for (int y = 0; y < height; ++y) {
    const std::uint32_t* id_row = seen.view().row<std::uint32_t>(id, 0, y);
    const float* z_row = seen.view().row<float>(z, 0, y);
    for (int x = 0; x < width; ++x) {
      // OpenGL counts rows from the bottom.
      const auto i = static_cast<std::size_t>(height - 1 - y) * width + static_cast<std::size_t>(x);
      const bool we_see = id_row[x] != no_face, they_see = theirs.depth[i] < 1;
      covered += we_see, their_covered += they_see;
      if (!we_see || !they_see) continue;
      const std::uint32_t source = origin == nullptr ? id_row[x] : origin->values<std::uint32_t>()[id_row[x]];
      other_id += source != theirs.face[i];
      other_depth += std::abs((z_row[x] + 1) / 2 - theirs.depth[i]) > 1e-4F;  // ours runs from -1 to 1
    }
  }
  state.counters["covered"] = covered;
  state.counters["llvmpipe_covered"] = their_covered;
  state.counters["other_id_percent"] = 100 * other_id / covered;
  state.counters["other_depth_percent"] = 100 * other_depth / covered;
}

// Without the peer: what a profile is taken of.
void frame_alone(benchmark::State& state, const bench::FrameScene& of, int samples) {
  current_mesh = of.mesh;
  const Registry registry = nodes_and_scene();
  const Graph graph = frame_graph(registry, of, samples);
  for (auto _ : state) benchmark::DoNotOptimize(result_of(graph));
}

void frame_in_turns(benchmark::State& state, const bench::FrameScene& of, int samples) {
  current_mesh = of.mesh;
  const Registry registry = nodes_and_scene();
  const Graph graph = frame_graph(registry, of, samples);
  const auto ours = [&] { benchmark::DoNotOptimize(result_of(graph)); };
  ours();
  const auto texture = peer_texture();
  bench::Llvmpipe peer(peer_scene(of, samples, texture));
  peer.frame();
  double best = 1e9, peer_best = 1e9;
  for (auto _ : state) {
    const double s = seconds_of(ours);
    state.SetIterationTime(s);
    best = std::min(best, s);
    peer_best = std::min(peer_best, seconds_of([&] { peer.frame(); }));
  }
  state.SetLabel(peer.name());
  state.counters["frustum_ms"] = 1e3 * best;
  state.counters["llvmpipe_ms"] = 1e3 * peer_best;
  state.counters["ratio"] = best / peer_best;
  if (samples == 1) compare_visibility(graph, peer, state);
}

void add(const std::string& name, bench::FrameScene (*make)(), int samples) {
  benchmark::RegisterBenchmark(("frame/" + name).c_str(),
                               [=](benchmark::State& state) { frame_in_turns(state, make(), samples); })
      ->UseManualTime()
      ->Iterations(15)
      ->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark(("frame_alone/" + name).c_str(),
                               [=](benchmark::State& state) { frame_alone(state, make(), samples); })
      ->MeasureProcessCPUTime()
      ->UseRealTime()
      ->Iterations(50)
      ->Unit(benchmark::kMillisecond);
}

const bool added = [] {
  add(
      "1M_triangles", [] { return bench::torus(1000, 500); }, 1);
  add(
      "100k_triangles", [] { return bench::torus(316, 158); }, 1);
  add(
      "10k_triangles", [] { return bench::torus(100, 50); }, 1);
  add(
      "1k_triangles", [] { return bench::torus(32, 16); }, 1);
  add("soup_100k_triangles", bench::soup, 1);
  add("8_layers", bench::layers, 1);
  add(
      "100k_triangles_4_samples", [] { return bench::torus(316, 158); }, 4);
  return true;
}();

}  // namespace
}  // namespace frustum
