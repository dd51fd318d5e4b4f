#include "nodes/io/load_scene.h"

#include "nodes/io.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/gltf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  FilePath file;
  std::string camera = {};
  glm::ivec2 resolution{1280, 720};
  bool textures = true;
};
struct Outputs {
  Ref<Mesh> mesh;
  Ref<Camera> camera;
  Ref<LightSet> lights;
};

Camera camera_of_box(const Mesh& mesh, const glm::ivec2& resolution) {
  constexpr double far_away = std::numeric_limits<double>::infinity();
  const Column& position = mesh.at("position");
  glm::dvec3 low{far_away}, high{-far_away};
  for (std::size_t i = 0; i < position.rows(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double v = position.number(i, k);
      low[k] = std::min(low[k], v), high[k] = std::max(high[k], v);
    }
  if (position.rows() == 0) low = high = glm::dvec3(0);
  return fitted_camera(low, high, resolution);
}

// By the name of its node or its own, else by number.
const Camera& chosen(const GltfScene& scene, const Params& p) {
  for (const auto& view : scene.views)
    if (view.node == p.camera || view.name == p.camera) return view.camera;
  std::size_t number = 0;
  const char* end = p.camera.data() + p.camera.size();
  const auto [stop, error] = std::from_chars(p.camera.data(), end, number);
  if (error == std::errc() && stop == end && number < scene.views.size()) return scene.views[number].camera;
  std::vector<std::string> known;
  for (const auto& view : scene.views)
    known.push_back(fmt::format("\"{}\"", view.node.empty() ? view.name : view.node));
  throw NodeError("unknown_camera",
                  fmt::format("{} has no camera \"{}\"; it has {}: {}", p.file.written, p.camera,
                              scene.views.size(), fmt::join(known, ", ")),
                  at_param("camera"));
}

void check(const Params& p) {
  if (p.file.empty()) throw NodeError("no_file", "no file is named", at_param("file"));
}

Outputs run(const Inputs&, const Params& p, Context& ctx) {
  const FileBytes bytes(p.file);
  GltfScene scene = read_gltf(bytes.text(), p.file, p.textures, ctx);
  Camera camera;
  if (!p.camera.empty())
    camera = chosen(scene, p);
  else if (!scene.views.empty())
    camera = scene.views[0].camera;
  else
    camera = camera_of_box(scene.mesh, p.resolution);
  camera.resolution = p.resolution;
  if (scene.lights.lights.empty()) scene.lights = usual_lights(camera);
  ctx.count("cameras", scene.views.size());
  return {std::make_shared<Mesh>(std::move(scene.mesh)), std::make_shared<Camera>(camera),
          std::make_shared<LightSet>(std::move(scene.lights))};
}

}  // namespace

NodeType nodes::io_load_scene() {
  NodeType type =
      node("io.load_scene", run)
          .doc("Reads a glTF scene: its triangles with their materials, a camera, and its lights.")
          .cite("Khronos, glTF 2.0, ISO/IEC 12113:2022; KHR_lights_punctual")
          .foreign()
          .param("file", &Params::file, "A .gltf or .glb file; what it names must lie in its folder.")
          .param("camera", &Params::camera,
                 "Name of the camera or of its node, or its number from 0; empty takes the first.")
          .param("resolution", &Params::resolution, "Width and height of the picture; a file says neither.",
                 {.unit = "px", .range = between(1, 65536)})
          .param("textures", &Params::textures, "Whether pictures are read; without, materials are plain.")
          .check(check)
          .output("mesh", &Outputs::mesh, "Every instance of every mesh of the default scene, in its place.",
                  {.space = Space::world})
          .output("camera", &Outputs::camera,
                  "The camera chosen; of a file without any, one that sees everything.")
          .output(
              "lights", &Outputs::lights,
              "The file's lights; of a file without any, one over the camera's left shoulder and some all "
              "around.");
  depend_on_files_beside(type);
  return type;
}

}  // namespace frustum
