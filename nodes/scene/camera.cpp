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
  check_subpixel_bits(p.conventions, p.subpixel_bits);
}

std::string states(const Params& p) { return stated(p.conventions, p.reversed_z, p.subpixel_bits); }

Outputs run(const Inputs&, const Params& p, Context&) {
  auto c = std::make_shared<Camera>();
  c->eye = p.eye, c->target = p.target, c->up = p.up;
  c->fov_y = p.fov_y * std::numbers::pi / 180;
  c->near_z = p.near, c->far_z = far_of(p);
  c->height = p.height;
  c->reversed_z = p.reversed_z;
  c->conventions = p.conventions, c->subpixel_bits = p.subpixel_bits;
  c->resolution = p.resolution;
  return {std::move(c)};
}

}  // namespace

NodeType nodes::scene_camera() {
  return node("scene.camera", run)
      .doc("Where the picture is taken from: place, direction, view volume and size in pixels.")
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
             {.unit = "world units", .range = above(0)})
      .param("reversed_z", &Params::reversed_z, reversed_z_doc)
      .knob_of_taste({"false", "true"}, reversed_z_basis)
      .param("conventions", &Params::conventions, conventions_doc)
      .knob_of_taste({"gl", "vulkan", "d3d"}, conventions_basis)
      .param("subpixel_bits", &Params::subpixel_bits, subpixel_bits_doc, {.range = between(4, 8)})
      .knob({"4", "5", "6", "7", "8"}, subpixel_bits_basis)
      .param("resolution", &Params::resolution,
             "Width and height of the picture; their ratio is that of the view.",
             {.unit = "px", .range = between(1, 65536)})
      .check(check)
      .states(states)
      .output("camera", &Outputs::camera, "The camera, for the nodes that project, tessellate and shade.");
}

}  // namespace frustum
