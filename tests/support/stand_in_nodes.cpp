#include "tests/support/stand_in_nodes.h"

#include "runtime/buffers/camera.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/material.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/surface.h"
#include "runtime/buffers/texture.h"
#include "runtime/buffers/value.h"

#include <variant>

namespace frustum::test {
namespace {

template <class I, class P, class O>
O nothing(const I&, const P&, Context&) {
  return {};
}
template <class I, class P, class O>
NodeBuilder<I, P, O> stand_in(std::string_view name) {
  return node<I, P, O>(name, nothing<I, P, O>);
}
template <class I, class P, class O>
Prepared<int, O> prepare_nothing(const I&, const P&, Context&) {
  return {0, {}};
}
template <class I, class O>
void fill_nothing(const int&, const TilesOf<I>&, const TilesOf<O>&, Arena&) {}
template <class I, class P, class O>
NodeBuilder<I, P, O> pixel_stand_in(std::string_view name) {
  return pixel_node<I, P, O, int>(name, prepare_nothing<I, P, O>, fill_nothing<I, O>);
}

struct None {};
struct MeshIn {
  Ref<Mesh> mesh;
};
struct MeshOut {
  Ref<Mesh> mesh;
};
struct MeshCameraIn {
  Ref<Mesh> mesh;
  Ref<Camera> camera;
};
struct LightOut {
  Ref<LightSet> light;
};
struct ImageOut {
  Tiled<Image> image;
};

namespace load_patches {
struct Params {
  FilePath file;
};
struct Outputs {
  Ref<Surface> surface;
};
NodeType type() {
  return stand_in<None, Params, Outputs>("io.load_patches")
      .param("file", &Params::file, "")
      .output("surface", &Outputs::surface, "", {.space = Space::object});
}
}  // namespace load_patches

namespace camera {
struct Params {
  glm::dvec3 eye{0, 0, 5}, target{0};
  double fov_y = 35;
  glm::ivec2 resolution{1280, 720};
};
struct Outputs {
  Ref<Camera> camera;
};
NodeType type() {
  return stand_in<None, Params, Outputs>("scene.camera")
      .param("eye", &Params::eye, "")
      .param("target", &Params::target, "")
      .param("fov_y", &Params::fov_y, "",
             {.unit = "degrees", .range = {.low = 0, .high = 180, .open_low = true, .open_high = true}})
      .param("resolution", &Params::resolution, "", {.unit = "px", .range = between(1, 65536)})
      .output("camera", &Outputs::camera, "");
}
}  // namespace camera

namespace light {
struct Params {
  glm::dvec3 direction{0, -1, 0};
  Color color{glm::dvec3(1)};
};
NodeType type() {
  return stand_in<None, Params, LightOut>("light.directional")
      .param("direction", &Params::direction, "")
      .param("color", &Params::color, "", {.range = at_least(0)})
      .output("light", &LightOut::light, "");
}
}  // namespace light

namespace affine {
struct Rotate {
  glm::dvec3 axis{0, 1, 0};
  double degrees = 0;
};
inline void describe(Fields<Rotate>& f) {
  f.field("axis", &Rotate::axis, "").field("degrees", &Rotate::degrees, "", {.unit = "degrees"});
}
struct Step {
  std::optional<glm::dvec3> translate;
  std::optional<Rotate> rotate;
};
inline void describe(Fields<Step>& f) {
  f.field("translate", &Step::translate, "").field("rotate", &Step::rotate, "").exactly_one();
}
using Geometry = std::variant<Ref<Mesh>, Ref<Surface>>;
struct Inputs {
  Geometry geometry;
  std::optional<Ref<Matrix>> matrix;
};
struct Params {
  std::vector<Step> steps;
};
struct Outputs {
  Geometry geometry;
};
NodeType type() {
  return stand_in<Inputs, Params, Outputs>("transform.affine")
      .input("geometry", &Inputs::geometry, "", {.space = {Space::object, Space::world}})
      .input("matrix", &Inputs::matrix, "")
      .param("steps", &Params::steps, "")
      .output("geometry", &Outputs::geometry, "");
}
}  // namespace affine

namespace tessellate {
struct Inputs {
  Ref<Surface> surface;
  std::optional<Ref<Camera>> camera;
};
struct Params {
  double tolerance_px = 0.5;
};
NodeType type() {
  return stand_in<Inputs, Params, MeshOut>("surface.tessellate")
      .input("surface", &Inputs::surface, "")
      .input("camera", &Inputs::camera, "")
      .param("tolerance_px", &Params::tolerance_px, "", {.unit = "px", .range = above(0)})
      .output("mesh", &MeshOut::mesh, "", {.space = Space::world});
}
}  // namespace tessellate

NodeType view() {
  return stand_in<MeshCameraIn, None, MeshOut>("project.view")
      .input("mesh", &MeshCameraIn::mesh, "", {.space = {Space::object, Space::world}})
      .input("camera", &MeshCameraIn::camera, "")
      .output("mesh", &MeshOut::mesh, "", {.space = Space::eye});
}
NodeType perspective() {
  return stand_in<MeshCameraIn, None, MeshOut>("project.perspective")
      .input("mesh", &MeshCameraIn::mesh, "", {.space = Space::eye})
      .input("camera", &MeshCameraIn::camera, "")
      .output("mesh", &MeshOut::mesh, "", {.space = Space::clip});
}
NodeType viewport() {
  return stand_in<MeshCameraIn, None, MeshOut>("project.viewport")
      .input("mesh", &MeshCameraIn::mesh, "", {.space = {Space::clip, Space::ndc}})
      .input("camera", &MeshCameraIn::camera, "")
      .output("mesh", &MeshOut::mesh, "", {.space = Space::screen});
}
NodeType backface() {
  return stand_in<MeshIn, None, MeshOut>("cull.backface")
      .input("mesh", &MeshIn::mesh, "")
      .output("mesh", &MeshOut::mesh, "");
}

namespace homogeneous {
enum class Planes : std::uint8_t { all, near };
constexpr auto choices(Planes) {
  return std::array{std::pair{Planes::all, "all"}, std::pair{Planes::near, "near"}};
}
struct Params {
  Planes planes = Planes::all;
  double guard_band = 1;
};
NodeType type() {
  return stand_in<MeshIn, Params, MeshOut>("clip.homogeneous")
      .input("mesh", &MeshIn::mesh, "", {.space = Space::clip})
      .param("planes", &Params::planes, "")
      .param("guard_band", &Params::guard_band, "", {.unit = "w", .range = at_least(1)})
      .output("mesh", &MeshOut::mesh, "");
}
}  // namespace homogeneous

namespace pattern {
enum class Kind : std::uint8_t { grid, sobol };
constexpr auto choices(Kind) {
  return std::array{std::pair{Kind::grid, "grid"}, std::pair{Kind::sobol, "sobol"}};
}
struct Params {
  int samples = 4;
  Kind kind = Kind::grid;
};
struct Outputs {
  Ref<SamplePattern> pattern;
};
NodeType type() {
  return stand_in<None, Params, Outputs>("supersample.pattern")
      .param("samples", &Params::samples, "", {.range = between(1, 4096)})
      .param("kind", &Params::kind, "")
      .output("pattern", &Outputs::pattern, "");
}
}  // namespace pattern

namespace triangles {
struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Outputs {
  Tiled<Visibility> visibility;
  Tiled<Depth> depth;
};
NodeType type() {
  return pixel_stand_in<Inputs, None, Outputs>("rasterize.triangles")
      .input("mesh", &Inputs::mesh, "", {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "")
      .output("visibility", &Outputs::visibility, "")
      .output("depth", &Outputs::depth, "");
}
}  // namespace triangles

namespace sample {
struct Inputs {
  Tiled<Visibility> hits;
  Ref<Texture> texture;
};
NodeType type() {
  return pixel_stand_in<Inputs, None, ImageOut>("texture.sample")
      .input("hits", &Inputs::hits, "")
      .input("texture", &Inputs::texture, "")
      .output("image", &ImageOut::image, "");
}
}  // namespace sample

namespace checker {
struct Params {
  double scale = 8;
};
struct Outputs {
  Ref<Texture> texture;
};
NodeType type() {
  return stand_in<None, Params, Outputs>("texture.checker")
      .param("scale", &Params::scale, "", {.range = above(0)})
      .output("texture", &Outputs::texture, "");
}
}  // namespace checker

namespace surface {
struct Inputs {
  Tiled<Visibility> hits;
  std::optional<Tiled<Image>> albedo;
  std::vector<Ref<LightSet>> lights;
};
enum class Interpolation : std::uint8_t { flat, gouraud, phong };
constexpr auto choices(Interpolation) {
  return std::array{std::pair{Interpolation::flat, "flat"}, std::pair{Interpolation::gouraud, "gouraud"},
                    std::pair{Interpolation::phong, "phong"}};
}
struct Params {
  Interpolation interpolation = Interpolation::phong;
};
NodeType type() {
  return pixel_stand_in<Inputs, Params, ImageOut>("shade.surface")
      .input("hits", &Inputs::hits, "")
      .input("albedo", &Inputs::albedo, "")
      .input("lights", &Inputs::lights, "")
      .param("interpolation", &Params::interpolation, "")
      .output("image", &ImageOut::image, "");
}
}  // namespace surface

namespace convert {
struct Inputs {
  Tiled<Image> image;
};
struct Params {
  std::string to = "srgb";
};
NodeType type() {
  return pixel_stand_in<Inputs, Params, ImageOut>("color.convert")
      .input("image", &Inputs::image, "")
      .param("to", &Params::to, "")
      .output("image", &ImageOut::image, "");
}
}  // namespace convert

namespace statistics {
struct Inputs {
  Ref<Image> image;
};
struct Outputs {
  Ref<Table> table;
};
NodeType type() {
  return stand_in<Inputs, None, Outputs>("check.statistics")
      .input("image", &Inputs::image, "")
      .output("table", &Outputs::table, "");
}
}  // namespace statistics

}  // namespace

const Registry& stand_in_nodes() {
  static const Registry registry = [] {
    std::vector<NodeType> types;
    for (NodeType (*type)() :
         {load_patches::type, camera::type, light::type, affine::type, tessellate::type, view, perspective,
          viewport, backface, homogeneous::type, pattern::type, triangles::type, sample::type, checker::type,
          surface::type, convert::type, statistics::type})
      types.push_back(type());
    return Registry(std::move(types));
  }();
  return registry;
}

}  // namespace frustum::test
