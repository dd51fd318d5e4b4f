#include "nodes/project/perspective.h"

#include "nodes/project.h"
#include "runtime/buffers/mesh_positions.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  Ref<Camera> camera;
};
struct Params {};
struct Outputs {
  Ref<Mesh> mesh;
};

kernels::Projection volume_of(const Camera& c) {
  const double aspect = c.resolution.y > 0 ? c.aspect() : 0;
  const auto fault = project::fault_of_perspective(c.fov_y, aspect, c.near_z, c.far_z);
  if (!fault.empty()) throw NodeError("impossible_camera", std::string(fault), at_input("camera"));
  return kernels::perspective(c.fov_y, aspect, c.near_z, c.far_z, clip_space(&c));
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  return {in_clip_space(*in.mesh, in.camera, volume_of(*in.camera), ctx)};
}

}  // namespace

NodeType nodes::project_perspective() {
  return node("project.perspective", run)
      .doc("Maps the camera's view pyramid to clip space; what is twice as far away becomes half as large.")
      .cite("OpenGL 4.6 compatibility profile, glFrustum; errata E9")
      .covers(20)
      .input("mesh", &Inputs::mesh, "A mesh in eye space.", {.space = Space::eye})
      .input("camera", &Inputs::camera, "Whose view volume it is.")
      .output("mesh", &Outputs::mesh, "Position in clip space: x, y, z, w, not divided; all else is shared.",
              {.space = Space::clip});
}

}  // namespace frustum
