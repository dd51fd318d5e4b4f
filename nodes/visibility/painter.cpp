#include "nodes/visibility/painter.h"

#include <fmt/format.h>

#include "nodes/visibility.h"
#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/step_table.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace painter {
constexpr auto choices(Key) {
  return std::array{std::pair{Key::farthest, "farthest"}, std::pair{Key::middle, "middle"},
                    std::pair{Key::nearest, "nearest"}, std::pair{Key::overlap, "overlap"}};
}
}  // namespace painter
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  painter::Key key = painter::Key::overlap;
  int rows = 1000;
};
struct Outputs {
  Ref<PaintOrder> order;
  Ref<Table> steps;
};

void report(const painter::Order& order, Context& ctx) {
  ctx.count("comparisons", order.comparisons);
  ctx.count("pairs_hiding", order.hidings);
  ctx.count("cycles", order.cycles);
  if (order.cycles == 0) return;
  const auto members =
      order.cycle.size() - static_cast<std::size_t>(std::count(order.cycle.begin(), order.cycle.end(), 0u));
  ctx.warn("cyclic_overlap",
           fmt::format("{} faces hide one another in {} cycle{}, so that no order of whole faces is right; "
                       "visibility.depth_sort and visibility.bsp cut them",
                       members, order.cycles, order.cycles == 1 ? "" : "s"));
}

Ref<Table> steps_of(const painter::Order& order, std::span<const kernels::ScreenFace> faces, double sign,
                    int rows, Context& ctx) {
  StepTable steps({{.name = "face"}, {.name = "nearest"}, {.name = "farthest"}, {.name = "cycle"}}, rows);
  for (std::size_t i = 0; i < order.face.size(); ++i) {
    if (steps.full()) {
      steps.leave_out();
      continue;
    }
    const kernels::ScreenFace& f = faces[order.face[i]];
    kernels::DepthSpan d;
    for (const kernels::GridPoint& c : f.corner) d.add(f.depth.at(kernels::to_px(c)));
    steps.add(order.face[i], sign * d.least, sign * d.greatest, order.cycle[i]);
  }
  return steps.table(ctx, 1);
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::PixelRect window = pixel_rect(picture_window(*in.mesh));
  return ctx.real([&]<class R>() -> Outputs {
    const ScreenView<R> view(in.mesh);
    const R sign = depth_order(*in.mesh) == kernels::DepthOrder::standard ? R(1) : R(-1);
    ctx.claim(in.mesh->faces() * sizeof(kernels::ScreenFace));
    const auto faces = kernels::screen_faces(view.triangles(), sign);
    const painter::Watch watch{[&] { ctx.poll(); }, [&](std::uint64_t bytes) { ctx.claim(bytes); }};
    const painter::Order found = painter::order(faces, window, p.key, watch);
    report(found, ctx);
    auto order = std::make_shared<PaintOrder>();
    order->faces = static_cast<std::uint32_t>(faces.size());
    for (const std::uint32_t f : found.face) order->pieces.push_back({f, 0, 0});
    return {std::move(order), steps_of(found, faces, static_cast<double>(sign), p.rows, ctx)};
  });
}

}  // namespace

NodeType nodes::visibility_painter() {
  return node("visibility.painter", run)
      .doc("Puts whole faces in the order in which a painter paints them, and finds those that have none.")
      .cite(
          "Newell, Newell & Sancha 1972, A Solution to the Hidden Surface Problem, doi:10.1145/800193.569954")
      .covers(44, 46)
      .input("mesh", &Inputs::mesh, "Opaque triangles; those that miss the picture are left out.",
             {.space = Space::screen})
      .param("key", &Params::key,
             "One depth of each face, or who hides whom where they overlap, which is right unless faces form "
             "cycles.")
      .knob({"nearest", "middle", "farthest", "overlap"},
            "One depth cannot order faces of unlike size; pairs cost time that grows with their number.")
      .param("rows", &Params::rows, "How many steps are kept; raising it keeps more of a long list.",
             {.range = at_least(0)})
      .output("order", &Outputs::order, "For visibility.paint, farthest first.")
      .output("steps", &Outputs::steps, "The faces as they are painted; those with a number share a cycle.");
}

}  // namespace frustum
