#include "nodes/project/viewport.h"

#include "nodes/project.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

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

// Without the faces that have a corner where there is no point.
Mesh in_front(const Mesh& mesh, std::span<const std::uint8_t> no_point, Context& ctx) {
  const auto triangles = mesh.triangles();
  const auto faces = kernels::indices_where(triangles.size(), [&](std::size_t f) {
    const auto& t = triangles[f];
    return (no_point[t.x] | no_point[t.y] | no_point[t.z]) == 0;
  });
  if (const auto dropped = triangles.size() - faces.size(); dropped > 0)
    ctx.warn("faces_behind_the_eye",
             fmt::format("{} faces were dropped: a corner has w <= 0 or is not finite; "
                         "clip.homogeneous before this node keeps their visible part",
                         dropped));
  return select_faces(mesh, faces);
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  const auto& resolution = in.camera->resolution;
  if (resolution.x < 1 || resolution.y < 1)
    throw NodeError("impossible_camera", fmt::format("the resolution is {} x {}, and must be at least 1 x 1",
                                                     resolution.x, resolution.y));
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<4, R>;
    const auto clip = in.mesh->real<R>("position");
    auto screen = Column::make<Point>("position", Domain::vertex, clip->rows(), Space::screen);
    std::vector<std::uint8_t> no_point(clip->rows());
    const auto without =
        project::clip_to_screen<R>(kernels::Viewport(resolution), clip->template values<Point>(),
                                   screen->template values<Point>(), no_point);
    *out = in.mesh->with(std::move(screen));
    if (without > 0) *out = in_front(*out, no_point, ctx);
  });
  out->camera = in.camera;
  ctx.count("vertices", out->vertices());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::project_viewport() {
  return node("project.viewport", run)
      .doc("Divides by w and maps to pixels: position becomes x_px, y_px (down), z and 1/w.")
      .cite("Errata E10 to E12: the viewport restores the aspect, after clipping and the divide")
      .covers(21)
      .input("mesh", &Inputs::mesh, "A clipped mesh in clip space.", {.space = Space::clip})
      .input("camera", &Inputs::camera, "Whose resolution the picture has.")
      .output("mesh", &Outputs::mesh,
              "Position on the screen; faces with a corner on or behind the eye's plane are dropped.",
              {.space = Space::screen});
}

}  // namespace frustum
