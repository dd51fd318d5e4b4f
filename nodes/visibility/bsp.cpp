#include "nodes/visibility/bsp.h"

#include <fmt/format.h>

#include "nodes/visibility.h"
#include "runtime/buffers/paint_order.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/step_table.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace bsp {
constexpr auto choices(Splitter) {
  return std::array{std::pair{Splitter::first, "first"}, std::pair{Splitter::least_splits, "least_splits"},
                    std::pair{Splitter::balanced, "balanced"}};
}
}  // namespace bsp
namespace {

enum class Traversal : std::uint8_t { back_to_front, front_to_back };
constexpr auto choices(Traversal) {
  return std::array{std::pair{Traversal::back_to_front, "back_to_front"},
                    std::pair{Traversal::front_to_back, "front_to_back"}};
}

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {
  bsp::Splitter splitter = bsp::Splitter::balanced;
  int candidates = 8;
  Traversal traversal = Traversal::back_to_front;
  int rows = 1000;
};
struct Outputs {
  Ref<PaintOrder> order;
  Ref<Table> tree;
};

std::string text_of(const bsp::Node& n) {
  if (n.kind == kernels::Cut::Kind::column) return fmt::format("x = {} px", n.of);
  if (n.kind == kernels::Cut::Kind::row) return fmt::format("y = {} px", n.of);
  return fmt::format("plane of face {}", n.of);
}

Ref<Table> table_of(const bsp::Tree& tree, int rows, Context& ctx) {
  StepTable steps({{.name = "divider"},
                   {.name = "depth"},
                   {.name = "level"},
                   {.name = "near"},
                   {.name = "far"},
                   {.name = "splits"}},
                  rows);
  for (const bsp::Node& n : tree.nodes) {
    if (steps.full())
      steps.leave_out();
    else
      steps.add(text_of(n), n.depth, n.pieces, n.low_pieces, n.high_pieces, n.splits);
  }
  return steps.table(ctx, 1);
}

void report(const bsp::Tree& tree, Context& ctx) {
  ctx.count("comparisons", tree.comparisons);
  ctx.count("splits", tree.splits);
  ctx.count("nodes", tree.nodes.size());
  ctx.count("pieces", tree.pieces.size());
  ctx.count("depth", tree.depth);
}

Ref<PaintOrder> order_of(const bsp::Tree& tree, std::span<const kernels::ScreenFace> faces,
                         bool front_to_back) {
  auto order = std::make_shared<PaintOrder>();
  order->faces = static_cast<std::uint32_t>(faces.size());
  order->front_to_back = front_to_back;
  const glm::dvec4 eye(0, 0, -1, 0);  // the camera's, whose rays are parallel on the screen
  bsp::traverse(tree, faces, eye, front_to_back, [&](const bsp::Node& n) {
    for (std::uint32_t k = 0; k < n.pieces; ++k) order->add(tree.pieces[n.first_piece + k]);
  });
  return order;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  const kernels::PixelRect window = pixel_rect(picture_window(*in.mesh));
  return ctx.real([&]<class R>() -> Outputs {
    const ScreenView<R> view(in.mesh);
    const R sign = depth_order(*in.mesh) == kernels::DepthOrder::standard ? R(1) : R(-1);
    ctx.claim(in.mesh->faces() * sizeof(kernels::ScreenFace));
    const auto faces = kernels::screen_faces(view.triangles(), sign);
    const bsp::Watch watch{[&] { ctx.poll(); }, [&](std::uint64_t bytes) { ctx.claim(bytes); }};
    const bsp::Tree tree = bsp::build(faces, window, {p.splitter, p.candidates}, watch);
    report(tree, ctx);
    return {order_of(tree, faces, p.traversal == Traversal::front_to_back), table_of(tree, p.rows, ctx)};
  });
}

}  // namespace

NodeType nodes::visibility_bsp() {
  return node("visibility.bsp", run)
      .doc(
          "Divides space by planes of the faces into a tree, and puts the faces in order by walking through "
          "it.")
      .cite(
          "Fuchs, Kedem & Naylor 1980, On Visible Surface Generation by A Priori Tree Structures, "
          "doi:10.1145/965105.807481")
      .covers(43, 46)
      .input("mesh", &Inputs::mesh, "Opaque triangles; those that miss the picture are left out.",
             {.space = Space::screen})
      .param("splitter", &Params::splitter,
             "Which plane divides a cell: the first, the one with the fewest splits, or the best balance for "
             "them.")
      .knob_of_taste({"first", "least_splits", "balanced"}, "Trees of other shapes show the same picture.")
      .param("candidates", &Params::candidates,
             "How many planes are tried for a cell; raising it splits less and takes longer.",
             {.range = between(1, 1000)})
      .param("traversal", &Params::traversal, "Which end of the order is painted first.")
      .param("rows", &Params::rows, "How many nodes are listed; raising it lists more of a large tree.",
             {.range = at_least(0)})
      .output("order", &Outputs::order, "For visibility.paint: faces and pieces of faces.")
      .output("tree", &Outputs::tree,
              "Its nodes, parents first: divider, depth, faces level with it, pieces near and far, splits.");
}

}  // namespace frustum
