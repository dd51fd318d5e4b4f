#include "nodes/visibility/paint.h"

#include <fmt/format.h>

#include "nodes/visibility.h"
#include "runtime/buffers/face_finder.h"
#include "runtime/buffers/paint_order.h"

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

// The painter, and what keeps its pieces.
template <std::floating_point R>
struct Canvas {
  Ref<PaintOrder> order;
  PiecePainter<R> painter;

  void fill(kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id, kernels::PlaneView<R> z) const {
    painter.fill(rect, id, z);
  }
};
using State = FaceFinders<Canvas<float>, Canvas<double>>;

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  if (in.order->faces != in.mesh->faces())
    throw NodeError(
        "wrong_mesh",
        fmt::format("the order is one of {} faces, and the mesh has {}", in.order->faces, in.mesh->faces()),
        at_input("mesh"));
  const std::size_t all = in.order->pieces.size();
  const std::size_t count = p.first ? std::min(all, static_cast<std::size_t>(*p.first)) : all;
  ctx.count("pieces_painted", count);
  return prepare_finder<State, Outputs>(in, ctx, [&]<class R>(const FinderScene<R>& s) {
    return Canvas<R>{
        in.order, PiecePainter<R>(s.mesh, s.pattern, s.window, s.order, in.order->scene(), count, s.claim)};
  });
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  fill_faces(state, out, arena);
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
