#include "nodes/visibility/depth_sort.h"

#include <fmt/format.h>

#include "nodes/visibility.h"
#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/step_table.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

using depth_sort::Event;

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  int rows = 1000;
};
struct Outputs {
  Ref<PaintOrder> order;
  Ref<Table> steps;
};

std::string text_of(Event event) {
  switch (event) {
    case Event::beside_x: return "no overlap in x";
    case Event::beside_y: return "no overlap in y";
    case Event::behind: return "the first lies behind the plane of the second";
    case Event::before: return "the second lies before the plane of the first";
    case Event::apart: return "their outlines do not overlap";
    case Event::overlap: return "where they overlap, the first lies behind";
    case Event::exchange: return "exchanged: the second is tried first";
    case Event::split: return "the first is split by the plane of the second";
    case Event::split_side: return "the first is split along a side of the second";
    case Event::unresolved: return "a circle that no split opens";
    case Event::painted: return "painted";
  }
  return {};
}

void report(const depth_sort::Counts& counts, const PaintOrder& order, Context& ctx) {
  ctx.count("comparisons", counts.comparisons);
  ctx.count("exchanges", counts.exchanges);
  ctx.count("splits", counts.splits);
  ctx.count("pieces", order.pieces.size());
  if (counts.unresolved > 0)
    ctx.warn("cyclic_overlap",
             fmt::format("{} circles of faces could not be opened by a split", counts.unresolved));
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::PixelRect window = pixel_rect(picture_window(*in.mesh));
  return ctx.real([&]<class R>() -> Outputs {
    const ScreenView<R> view(in.mesh);
    const R sign = depth_order(*in.mesh) == kernels::DepthOrder::standard ? R(1) : R(-1);
    ctx.claim(in.mesh->faces() * sizeof(kernels::ScreenFace));
    const auto faces = kernels::screen_faces(view.triangles(), sign);
    StepTable steps({{.name = "first"}, {.name = "second"}, {.name = "event"}}, p.rows);
    const depth_sort::Watch watch{[&] { ctx.poll(); }, [&](std::uint64_t bytes) { ctx.claim(bytes); },
                                  [&](const depth_sort::Step& s) {
                                    if (steps.full())
                                      steps.leave_out();
                                    else
                                      steps.add(s.first, s.second, text_of(s.event));
                                  }};
    auto order = std::make_shared<PaintOrder>();
    order->faces = static_cast<std::uint32_t>(faces.size());
    depth_sort::Sorter sorter(faces, window, watch);
    const auto counts = sorter.run([&](const kernels::Piece& piece) { order->add(piece); });
    report(counts, *order, ctx);
    return {std::move(order), steps.table(ctx, 1)};
  });
}

}  // namespace

NodeType nodes::visibility_depth_sort() {
  return node("visibility.depth_sort", run)
      .doc("Puts faces in the order in which they are painted, and splits those that cannot be put in one.")
      .cite(
          "Newell, Newell & Sancha 1972, A Solution to the Hidden Surface Problem, doi:10.1145/800193.569954")
      .covers(45, 46)
      .input("mesh", &Inputs::mesh, "Opaque triangles; those that miss the picture are left out.",
             {.space = Space::screen})
      .param("rows", &Params::rows, "How many steps are kept; raising it keeps more of a long list.",
             {.range = at_least(0)})
      .output("order", &Outputs::order, "For visibility.paint: faces and pieces of faces, farthest first.")
      .output("steps", &Outputs::steps,
              "Each pair that was looked at, the test that put it in order, exchanges and splits.");
}

}  // namespace frustum
