#include "nodes/visibility/paint.h"

#include <fmt/format.h>

#include "nodes/visibility.h"
#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Ref<PaintOrder> order;
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  std::optional<int> first;
};
struct Outputs {
  Tiled<Visibility> visibility;
  Tiled<Depth> depth;
};

template <class R>
struct Canvas {
  ScreenView<R> view;
  Ref<PaintOrder> order;
  Ref<SamplePattern> pattern;
  PiecePainter<R> painter;
};
using State = std::variant<Canvas<float>, Canvas<double>>;

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Rect window = picture_window(*in.mesh);
  if (in.order->faces != in.mesh->faces())
    throw NodeError(
        "wrong_mesh",
        fmt::format("the order is one of {} faces, and the mesh has {}", in.order->faces, in.mesh->faces()),
        at_input("mesh"));
  const std::size_t all = in.order->pieces.size();
  const std::size_t count = p.first ? std::min(all, static_cast<std::size_t>(*p.first)) : all;
  ctx.count("pieces_painted", count);
  return ctx.real([&]<class R>() -> Prepared<State, Outputs> {
    ScreenView<R> view(in.mesh);
    Ref<SamplePattern> pattern = in.pattern.value_or(nullptr);
    PiecePainter<R> painter(view.triangles(), sample_positions(pattern.get()), pixel_rect(window),
                            depth_order(*in.mesh), in.order->scene(), count,
                            [&ctx](std::uint64_t bytes) { ctx.claim(bytes); });
    Frame visibility = visibility_frame<R>(window, pattern), depth = depth_frame<R>(window, pattern);
    return {Canvas<R>{std::move(view), in.order, std::move(pattern), std::move(painter)},
            {std::move(visibility), std::move(depth)}};
  });
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  std::visit(
      [&]<class R>(const Canvas<R>& canvas) {
        fill_visibility<R>(out[&Outputs::visibility], out[&Outputs::depth], arena,
                           [&](kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id,
                               kernels::PlaneView<R> z) { canvas.painter.fill(rect, id, z); });
      },
      state);
}

}  // namespace

NodeType nodes::visibility_paint() {
  return pixel_node("visibility.paint", prepare, tile)
      .doc("Paints faces, or pieces of them, in an order that another node found: the last one is seen.")
      .cite(
          "Newell, Newell & Sancha 1972, A Solution to the Hidden Surface Problem, doi:10.1145/800193.569954")
      .covers(43, 44, 45)
      .input("order", &Inputs::order, "From visibility.painter, visibility.depth_sort or visibility.bsp.")
      .input("mesh", &Inputs::mesh, "The triangles that were put in order.", {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .param("first", &Params::first,
             "How many pieces are painted; left out, all. Raising it goes on painting.",
             {.range = at_least(0)})
      .output("visibility", &Outputs::visibility,
              "The face and its depth at each sample; depths that rounding cannot tell apart decide by "
              "themselves.")
      .output("depth", &Outputs::depth, "The depth alone; where nothing is painted, that of the far plane.");
}

}  // namespace frustum
