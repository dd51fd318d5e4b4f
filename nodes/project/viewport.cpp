#include "nodes/project/viewport.h"

#include "nodes/project.h"
#include "runtime/buffers/mesh_positions.h"
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

Verdict divide(const Inputs& in, const Params&, const Context& ctx) {
  return ctx.real([&]<class R>() {
    const auto column = in.mesh->real<R>("position");
    const auto clip = column->template values<glm::vec<4, R>>();
    const std::size_t vertex = kernels::first_to_divide<R>(clip);
    if (vertex == clip.size())
      return off_exact("w is 1 at every vertex: the projection is parallel", clip.size());
    return on(fmt::format("w is {:.6g} at vertex {}", clip[vertex].w, vertex), clip.size());
  });
}

// What is in one clip space would be upside down, or cut at other depths, in another.
void require_one_clip_space(const Inputs& in) {
  if (!in.mesh->camera) return;
  const auto of_mesh = clip_space(in.mesh->camera.get()), of_camera = clip_space(in.camera.get());
  if (of_mesh.depth == of_camera.depth && of_mesh.y_down == of_camera.y_down) return;
  throw NodeError(
      "conventions_differ",
      "the mesh was projected by a camera of other conventions than the one linked here: its clip "
      "space is another",
      at_input("camera"));
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  const auto& resolution = in.camera->resolution;
  if (resolution.x < 1 || resolution.y < 1)
    throw NodeError(
        "impossible_camera",
        fmt::format("the resolution is {} x {}, and must be at least 1 x 1", resolution.x, resolution.y),
        at_input("camera"));
  require_one_clip_space(in);
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Point = glm::vec<4, R>;
    ctx.claim(in.mesh->vertices());
    std::vector<std::uint8_t> no_point(in.mesh->vertices());
    std::size_t without = 0;
    *out = with_positions<Point, Point>(
        *in.mesh, Space::screen, ctx, [&](std::span<const Point> clip, std::span<Point> screen) {
          without = project::clip_to_screen<R>(ctx.simulates("perspective_divide"), viewport_of(*in.camera),
                                               clip, screen, no_point);
        });
    if (without > 0) *out = without_unplaced(*out, no_point, ctx);
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
      .input("camera", &Inputs::camera,
             "Whose resolution the picture has; its conventions are those that the mesh was projected with.")
      .effect("perspective_divide", divide, "Positions are divided by w.",
              {"vertex", 1})  // tests/bench/effects_bench.cpp, one thread: 0.5 to 1.1
      .output("mesh", &Outputs::mesh,
              "Position on the screen; faces with a corner on or behind the eye's plane are dropped.",
              {.space = Space::screen});
}

}  // namespace frustum
