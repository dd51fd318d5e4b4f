// A whole frame, in turns with Mesa's llvmpipe: a torus of a million triangles at 1920 x 1080, Phong shading
// with a Blinn highlight, a mipmapped 1024 x 1024 texture with trilinear filter, back faces culled. Both keep
// the mesh and the texture in memory and start from world space; frustum also publishes the linear float
// image. What is reported is the least time of each and their ratio: times drift, the ratio of turns does
// not.
#include "nodes/all_nodes.h"
#include "nodes/kernels/camera.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/texture.h"
#include "runtime/graph/load.h"
#include "runtime/graph/run.h"
#include "tests/bench/llvmpipe.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace frustum {
namespace {

constexpr int width = 1920, height = 1080, texture_edge = 1024, columns = 1000, rows = 500;
constexpr glm::dvec3 eye{0, 1.2, 2.2}, light_direction{-0.4, -0.7, -0.6};
constexpr double fov_y_deg = 45, near_z = 0.1, far_z = 100;

// A torus about the y axis, radii 0.7 and 0.3, with a seam where u and v wrap.
Ref<Mesh> make_torus() {
  const auto n = static_cast<std::size_t>((columns + 1) * (rows + 1));
  auto position = Column::make<glm::vec3>("position", Domain::vertex, n, Space::world);
  auto normal = Column::make<glm::vec3>("normal", Domain::vertex, n, Space::world);
  auto uv = Column::make<glm::vec2>("uv", Domain::vertex, n);
  auto face =
      Column::make<glm::uvec3>("triangle", Domain::face, static_cast<std::size_t>(2 * columns * rows));
  std::size_t v = 0, f = 0;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i, ++v) {
      const double a = 2 * std::numbers::pi * i / columns, b = 2 * std::numbers::pi * j / rows;
      const glm::dvec3 out(std::cos(b) * std::cos(a), std::sin(b), -std::cos(b) * std::sin(a));
      normal->values<glm::vec3>()[v] = out;
      position->values<glm::vec3>()[v] = 0.7 * glm::dvec3(std::cos(a), 0, -std::sin(a)) + 0.3 * out;
      uv->values<glm::vec2>()[v] = {static_cast<float>(i) / columns, static_cast<float>(j) / rows};
    }
  for (std::uint32_t j = 0; j < rows; ++j)
    for (std::uint32_t i = 0; i < columns; ++i) {
      const std::uint32_t p = j * (columns + 1) + i, q = p + columns + 1;
      face->values<glm::uvec3>()[f++] = {p, p + 1, q + 1};
      face->values<glm::uvec3>()[f++] = {p, q + 1, q};
    }
  Mesh mesh;
  mesh.columns = {face, position, normal, uv};
  return std::make_shared<const Mesh>(std::move(mesh));
}

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

Graph graph_of(const std::string& text, const Registry& registry) {
  const auto loaded = load_graph_text(text, "frame.json", registry);
  if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  return *loaded.graph;
}

// The first output of the last node.
Buffer result_of(const Graph& graph) {
  const PortRef last{graph.nodes.size() - 1, 0};
  RunOptions options;
  options.demand.ports.push_back(last);
  const RunResult result = run_graph(graph, options);
  if (result.end != RunResult::End::done) throw std::runtime_error(to_text(result.problems));
  return result.buffers.at(last);
}

// Made once: neither rasterizer's frame holds the making of the mesh or of the pyramid.
const Scene& kept_scene() {
  static const Scene kept = [] {
    std::vector<NodeType> types = all_node_types();
    types.push_back(node("bench.board", board).output("image", &Board::image, "A checkerboard."));
    const Registry registry(std::move(types));
    const Graph g = graph_of(R"({ "format": "frustum.graph/1", "nodes": {
      "image": { "type": "bench.board" },
      "texture": { "type": "texture.image", "in": { "image": "image" } } } })",
                             registry);
    return Scene{make_torus(), result_of(g).as<Texture>()};
  }();
  return kept;
}

Scene scene(const Inputs&, const Params&, Context&) { return kept_scene(); }

Registry nodes_and_scene() {
  std::vector<NodeType> types = all_node_types();
  types.push_back(node("bench.scene", scene)
                      .output("mesh", &Scene::mesh, "A torus.", {.space = Space::world})
                      .output("texture", &Scene::texture, "A checkerboard."));
  return Registry(std::move(types));
}

Graph frame_graph(const Registry& registry) {
  constexpr const char* text = R"({{
  "format": "frustum.graph/1",
  "nodes": {{
    "scene":  {{ "type": "bench.scene" }},
    "camera": {{ "type": "scene.camera", "params": {{ "eye": [{}, {}, {}], "target": [0, 0, 0], "fov_y": {},
                "near": {}, "far": {}, "resolution": [{}, {}] }} }},
    "key":    {{ "type": "light.directional", "params": {{ "direction": [{}, {}, {}] }} }},
    "fill":   {{ "type": "light.ambient", "params": {{ "color": [0.125, 0.125, 0.125] }} }},
    "clay":   {{ "type": "shade.material", "params": {{ "diffuse": 0.8, "specular": 0.3, "shininess": 32 }} }},
    "eye":    {{ "type": "project.view", "in": {{ "mesh": "scene.mesh", "camera": "camera" }} }},
    "clip":   {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
    "cut":    {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
    "front":  {{ "type": "cull.backface", "in": {{ "mesh": "cut" }} }},
    "screen": {{ "type": "project.viewport", "in": {{ "mesh": "front", "camera": "camera" }} }},
    "hits":   {{ "type": "rasterize.triangles", "in": {{ "mesh": "screen" }} }},
    "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }} }},
    "albedo": {{ "type": "texture.sample", "in": {{ "points": "points", "texture": "scene.texture" }} }},
    "lit":    {{ "type": "shade.surface", "in": {{ "points": "points", "mesh": "screen", "albedo": "albedo",
                "material": "clay", "lights": ["key", "fill"], "camera": "camera" }} }} }} }})";
  return graph_of(fmt::format(text, eye.x, eye.y, eye.z, fov_y_deg, near_z, far_z, width, height,
                              light_direction.x, light_direction.y, light_direction.z),
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

bench::PeerScene peer_scene(const Mesh& mesh, const std::vector<std::uint8_t>& texture) {
  const auto view = kernels::look_at(eye, glm::dvec3{0}, glm::dvec3{0, 1, 0}).eye_from_world;
  const double f = 1 / std::tan(fov_y_deg * std::numbers::pi / 360);
  glm::dmat4 clip_from_eye(0);
  clip_from_eye[0][0] = f * height / width, clip_from_eye[1][1] = f;
  clip_from_eye[2][2] = -(far_z + near_z) / (far_z - near_z), clip_from_eye[2][3] = -1;
  clip_from_eye[3][2] = -2 * far_z * near_z / (far_z - near_z);
  const glm::dvec3 to_light = -light_direction / std::sqrt(glm::dot(light_direction, light_direction));
  return {mesh.at("position").values<glm::vec3>(),
          mesh.at("normal").values<glm::vec3>(),
          mesh.at("uv").values<glm::vec2>(),
          mesh.triangles(),
          glm::mat4(clip_from_eye * kernels::matrix_of(view)),
          glm::vec3(eye),
          glm::vec3(to_light),
          width,
          height,
          texture_edge,
          texture.data()};
}

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::size_t covered(const Buffer& image) {
  const Raster& r = image.as<Image>()->raster;
  const int alpha = r.frame().find("A").value();
  std::size_t n = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) n += r.value(alpha, 0, x, y) > 0;
  return n;
}

void frame_in_turns(benchmark::State& state) {
  const Registry registry = nodes_and_scene();
  const Graph graph = frame_graph(registry);
  Buffer image;
  const auto ours = [&] { image = result_of(graph); };
  ours();
  const auto texture = peer_texture();
  bench::Llvmpipe peer(peer_scene(*kept_scene().mesh, texture));
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
  state.counters["covered"] = static_cast<double>(covered(image));
  state.counters["llvmpipe_covered"] = static_cast<double>(peer.covered_pixels());
}
BENCHMARK(frame_in_turns)
    ->Name("frame/1M_triangles_1080p_phong_texture")
    ->UseManualTime()
    ->Iterations(15)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace frustum
