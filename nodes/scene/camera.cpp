#include "nodes/scene/camera.h"

#include "nodes/scene.h"
#include "runtime/buffers/camera_choices.h"
#include "runtime/core/node_type.h"

#include <numbers>

namespace frustum {
namespace {

struct Inputs {};
struct Params {
  glm::dvec3 eye{0, 0, 5}, target{0}, up{0, 1, 0};
  double fov_y = 35;
  double near = 0.1;
  std::optional<double> far = 1000;
  double height = 2;
  bool reversed_z = false;
  Conventions conventions = Conventions::gl;
  int subpixel_bits = 8;
  glm::ivec2 resolution{1280, 720};
};
struct Outputs {
  Ref<Camera> camera;
};

double far_of(const Params& p) { return p.far.value_or(std::numeric_limits<double>::infinity()); }

void check(const Params& p) {
  const auto fault = scene::fault_of_camera(p.eye, p.target, p.up, p.near, far_of(p));
  if (!fault.empty()) throw NodeError("impossible_camera", std::string(fault.what), at_param(fault.param));
  check_camera_choices(p);
}

Outputs run(const Inputs&, const Params& p, Context&) {
  auto c = std::make_shared<Camera>();
  c->eye = p.eye, c->target = p.target, c->up = p.up;
  c->fov_y = p.fov_y * std::numbers::pi / 180;
  c->near_z = p.near, c->far_z = far_of(p);
  c->height = p.height;
  apply_camera_choices(p, *c);
  c->resolution = p.resolution;
  return {std::move(c)};
}

}  // namespace

NodeType nodes::scene_camera() {
  auto camera = node("scene.camera", run);
  camera.doc("Where the picture is taken from: place, direction, view volume and size in pixels.")
      .cite(
          "OpenGL 4.6 core profile, 13.6 to 13.8; Vulkan 1.3, Primitive Clipping and Controlling the "
          "Viewport")
      .cite(
          "Microsoft, Direct3D 11.3 functional specification: clipping, 16.8 fixed point, the leading vertex")
      .covers(22)
      .param("eye", &Params::eye, "Where the camera stands, in world space.", {.unit = "world units"})
      .param("target", &Params::target, "The point in the middle of the picture.", {.unit = "world units"})
      .param("up", &Params::up, "The direction that points up in the picture.")
      .param("fov_y", &Params::fov_y,
             "Angle between the top and bottom of a perspective; raising it shows more, smaller.",
             {.unit = "degrees", .range = {.low = 0, .high = 180, .open_low = true, .open_high = true}})
      .param("near", &Params::near,
             "Distance of the near plane; raising it saves depth precision and cuts more away.",
             {.unit = "world units", .range = above(0)})
      .param("far", &Params::far, "Distance of the far plane; null puts it at infinity.",
             {.unit = "world units", .range = above(0)})
      .param("height", &Params::height, "Height of the view volume of an orthographic projection.",
             {.unit = "world units", .range = above(0)});
  return camera_choices(camera)
      .param("resolution", &Params::resolution,
             "Width and height of the picture; their ratio is that of the view.",
             {.unit = "px", .range = between(1, 65536)})
      .check(check)
      .states(stated_camera_choices<Params>)
      .output("camera", &Outputs::camera, "The camera, for the nodes that project, tessellate and shade.");
}

}  // namespace frustum
