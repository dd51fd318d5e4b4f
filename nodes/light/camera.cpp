#include "nodes/light/camera.h"

#include "nodes/light.h"
#include "runtime/buffers/camera_choices.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <numbers>

namespace frustum {
namespace light_camera {
enum class Side : std::uint8_t { px, nx, py, ny, pz, nz };
constexpr auto choices(Side) {
  return std::array{std::pair{Side::px, "+x"}, std::pair{Side::nx, "-x"}, std::pair{Side::py, "+y"},
                    std::pair{Side::ny, "-y"}, std::pair{Side::pz, "+z"}, std::pair{Side::nz, "-z"}};
}
}  // namespace light_camera
namespace {

// A spot wider than this has more than 32 times the texels per angle at its rim than in its middle.
constexpr double widest = 80 * std::numbers::pi / 180;

struct Inputs {
  Ref<LightSet> light;
  Ref<Mesh> mesh;
};
struct Params {
  int size = 1024;
  light_camera::Side side = light_camera::Side::ny;
  Conventions conventions = Conventions::gl;
  int subpixel_bits = 8;
};
struct Outputs {
  Ref<Camera> camera;
};

const Light& only_source(const LightSet& set) {
  const Light* found = nullptr;
  for (const Light& l : set.lights) {
    if (l.kind == Light::Kind::ambient) continue;
    if (found != nullptr)
      throw NodeError("several_lights", "a camera stands at one light; this link carries several",
                      at_input("light"));
    found = &l;
  }
  if (found == nullptr)
    throw NodeError("no_source", "ambient light comes from everywhere: no camera can stand there",
                    at_input("light"));
  return *found;
}

light_camera::View view_of(const Light& light, const Params& p, std::span<const glm::dvec3> casters) {
  switch (light.kind) {
    case Light::Kind::directional: return light_camera::parallel_view(light.direction, casters, p.size);
    case Light::Kind::spot:
      if (light.outer > widest)
        throw NodeError("too_wide",
                        "the cone of the spot is wider than 80 degrees from its axis: no one picture "
                        "holds it; shade.shadow needs none",
                        at_input("light"));
      return light_camera::view_from(light.position, light.direction,
                                     light_camera::up_beside(light.direction), light.outer, casters, p.size);
    case Light::Kind::point: {
      const auto& [direction, up] = light_camera::cube[static_cast<std::size_t>(p.side)];
      return light_camera::view_from(light.position, direction, up, std::numbers::pi / 4, casters, p.size);
    }
    case Light::Kind::ambient:
    case Light::Kind::area: break;
  }
  throw NodeError("area_light", "a light with an area is in no one place: shade.shadow finds its shadows",
                  at_input("light"));
}

Outputs run(const Inputs& in, const Params& p, Context&) {
  const Ref<Column> position = in.mesh->real<double>("position");
  if (position->width() != 3)
    throw NodeError("wrong_column", "positions in world space have three components", at_input("mesh"));
  const light_camera::View v = view_of(only_source(*in.light), p, position->values<glm::dvec3>());
  Camera c{.eye = v.eye, .target = v.target, .up = v.up, .near_z = v.near_z, .far_z = v.far_z};
  if (v.height > 0) c.height = v.height;
  if (v.fov_y > 0) c.fov_y = v.fov_y;
  c.resolution = glm::ivec2(p.size);
  apply_camera_choices(p, c);
  return {std::make_shared<Camera>(c)};
}

}  // namespace

NodeType nodes::light_camera() {
  auto camera = node("light.camera", run);
  camera.doc("Puts a camera where a light is, such that its picture holds what may cast a shadow.")
      .cite("Williams 1978, Casting curved shadows on curved surfaces, doi:10.1145/965139.807402")
      .covers(61)
      .input("light", &Inputs::light, "One directional, spot or point light.")
      .input("mesh", &Inputs::mesh, "All that casts shadows.", {.space = {Space::object, Space::world}})
      .param("size", &Params::size,
             "Width and height of the picture; raising it narrows the band in which shadows are uncertain.",
             {.unit = "px", .range = between(4, 16384)})
      .knob({"256", "512", "1024", "2048", "4096"},
            "Edges of shadows are off by up to a texel: wholly, at a share of the points like 1/size.", -0.5)
      .param("side", &Params::side,
             "Which side of the cube around a point light; other lights have one view.");
  return camera_choices(camera)
      .check(check_camera_choices<Params>)
      .states(stated_camera_choices<Params>)
      .output("camera", &Outputs::camera,
              "For project.orthographic where the light is directional, else for project.perspective.");
}

}  // namespace frustum
