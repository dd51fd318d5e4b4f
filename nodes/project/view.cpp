#include "nodes/project/view.h"

#include "nodes/kernels/camera.h"
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

kernels::Affine eye_from_world(const Camera& camera, Context& ctx) {
  const auto [view, fault] = kernels::look_at(camera.eye, camera.target, camera.up);
  if (fault == kernels::LookAtFault::no_direction)
    ctx.warn("camera_without_direction", "the camera's eye and target are one point: it looks along -z");
  if (fault == kernels::LookAtFault::up_along_direction)
    ctx.warn("camera_up_along_view",
             "the camera looks along its up vector: the top of the picture is towards -z, or y "
             "where it looks along z");
  return view;
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  const kernels::Affine view = eye_from_world(*in.camera, ctx);
  auto out = std::make_shared<Mesh>();
  const Ref<Column> world = in.mesh->share("position");
  ctx.real([&]<class R>() {
    using Point = glm::vec<3, R>;
    *out = with_positions<Point, Point>(*in.mesh, Space::eye, ctx,
                                        [&](std::span<const Point> from, std::span<Point> eye) {
                                          project::world_to_eye<R>(view, from, eye);
                                        });
    *out = out->with(as_real<R>(world)->renamed("world", Space::world));
  });
  out->camera = in.camera;
  ctx.count("vertices", out->vertices());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::project_view() {
  return node("project.view", run)
      .doc("Moves a mesh into the camera's space: eye at the origin, looking along -z, y up.")
      .cite("Errata E11 and E13: the view matrix is the inverse of the camera's placement")
      .covers(22)
      .input("mesh", &Inputs::mesh, "A mesh in world space; object space is taken to be world space.",
             {.space = {Space::object, Space::world}})
      .input("camera", &Inputs::camera, "Where the picture is taken from.")
      .output("mesh", &Outputs::mesh,
              "Position in eye space; column world keeps the old one, normals stay in world space.",
              {.space = Space::eye});
}

}  // namespace frustum
