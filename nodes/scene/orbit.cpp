#include "nodes/scene/orbit.h"

#include "nodes/kernels/surface_measures.h"
#include "nodes/scene.h"
#include "runtime/buffers/camera_choices.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"

#include <numbers>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  std::int64_t frame = 0, frames = 48;
  double start = 30, elevation = 20, margin = 1.1, fov_y = 35;
  bool reversed_z = false;
  Conventions conventions = Conventions::gl;
  int subpixel_bits = 8;
  glm::ivec2 resolution{1280, 720};
};
struct Outputs {
  Ref<Camera> camera;
};

kernels::Box bounds_of(const Mesh& mesh, const Context& ctx) {
  const kernels::Box box = ctx.real([&]<class R>() {
    const auto position = mesh.real<R>("position");
    return kernels::bounds_of(
        kernels::Triangles<R>{position->template values<glm::vec<3, R>>(), mesh.triangles()});
  });
  if (box.empty())
    throw NodeError("no_bounds", "the mesh has no face with a finite corner, so there is nothing to circle",
                    at_input("mesh"));
  return box;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::Box box = bounds_of(*in.mesh, ctx);
  const double extent = kernels::norm(box.half_size());
  const double radius = extent > 0 ? extent : 1;  // a single point is looked at from a distance, too
  auto c = std::make_shared<Camera>();
  c->resolution = p.resolution;
  c->fov_y = p.fov_y * std::numbers::pi / 180;
  c->target = box.centre();
  const double distance = scene::orbit_distance(radius, p.margin, c->fov_y, c->aspect());
  c->eye = c->target + scene::orbit_direction(p.frame, p.frames, p.start, p.elevation) * distance;
  const auto [near_z, far_z] = scene::orbit_depths(distance, radius);
  c->near_z = near_z, c->far_z = far_z;
  apply_camera_choices(p, *c);
  return {std::move(c)};
}

}  // namespace

NodeType nodes::scene_orbit() {
  auto camera = node("scene.orbit", run);
  camera.doc("A camera that circles a mesh and always has all of it in the picture.")
      .input("mesh", &Inputs::mesh, "What it looks at: the ball around the box of its faces.",
             {.space = {Space::object, Space::world}})
      .param("frame", &Params::frame, "Which picture of the turn; raising it goes on counter-clockwise.")
      .param("frames", &Params::frames, "Pictures of a whole turn; raising it makes smaller steps.",
             {.range = between(1, 1e6)})
      .param("start", &Params::start, "Where frame 0 stands: 0 is +z of the centre, 90 is +x.",
             {.unit = "degrees"})
      .param("elevation", &Params::elevation, "Above the horizon; raising it looks down more.",
             {.unit = "degrees", .range = between(-90, 90)})
      .param("margin", &Params::margin, "Room around the mesh; 1 is none, raising it makes it smaller.",
             {.range = between(1, 100)})
      .param("fov_y", &Params::fov_y,
             "Angle between top and bottom; raising it moves the camera nearer: a stronger perspective.",
             {.unit = "degrees", .range = {.low = 0, .high = 180, .open_low = true, .open_high = true}});
  return camera_choices(camera)
      .param("resolution", &Params::resolution, "Width and height of the picture.",
             {.unit = "px", .range = between(1, 65536)})
      .check(check_camera_choices<Params>)
      .states(stated_camera_choices<Params>)
      .output("camera", &Outputs::camera, "The camera; near and far are just before and behind the mesh.");
}

}  // namespace frustum
