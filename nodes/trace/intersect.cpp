#include "nodes/trace/intersect.h"

#include "nodes/trace.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/rays.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> rays;
  Ref<Mesh> mesh;
};
struct Params {};
struct Outputs {
  Tiled<Image> hits;
};

struct State {
  RayReader rays;
  kernels::TriangleTree tree;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Frame& from = in.rays.frame();
  const PlaneKind real = real_kind(ctx.precision);
  Frame frame{.window = from.window,
              .pattern = from.pattern,
              .planes = {{"id", PlaneKind::u32}, {"t", real}, {"u", real}, {"v", real}}};
  State s{RayReader(in.rays, false), {}};
  const Ref<Column> position = in.mesh->real<double>("position");
  if (position->width() != 3)
    throw NodeError("wrong_column", "positions in world space have three components", at_input("mesh"));
  ctx.claim(kernels::TriangleTree::bytes(in.mesh->faces()));
  s.tree = {position->values<glm::dvec3>(), in.mesh->triangles(), [&ctx] { ctx.poll(); }};
  ctx.count("triangles", s.tree.triangles());
  if (const std::size_t left_out = in.mesh->faces() - s.tree.triangles(); left_out > 0)
    ctx.warn("faces_not_finite", std::to_string(left_out) +
                                     " of the faces have a corner that is NaN or infinite, and are not met");
  return {std::move(s), {std::move(frame)}};
}

template <class R>
void fill(const State& s, const Tile& rays, const Tile& to, Arena& arena) {
  const auto n = static_cast<std::size_t>(to.rect().width());
  const std::span<double> scratch = arena.take<double>(RayReader::scratch(n));
  for (int k = 0; k < to.samples(); ++k)
    for (int y = to.rect().y0; y < to.rect().y1; ++y) {
      const RayReader::Rows from = s.rays.rows(rays, k, y, scratch);
      std::uint32_t* const id = out_row<std::uint32_t>(to, 0, k, y);
      const std::array real{out_row<R>(to, 1, k, y), out_row<R>(to, 2, k, y), out_row<R>(to, 3, k, y)};
      for (std::size_t x = 0; x < n; ++x) {
        const trace::Met met = trace::nearest(s.tree, from.beam(x), from.slack(x));
        if (id != nullptr) id[x] = met.face;
        const std::array of{met.t, met.u, met.v};
        for (std::size_t i = 0; i < 3; ++i)
          if (real[i] != nullptr) real[i][x] = static_cast<R>(of[i]);
      }
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::hits];
  const Tile rays = in[&Inputs::rays].part(to.rect());
  if (to.frame().planes[1].kind == PlaneKind::f32)
    fill<float>(s, rays, to, arena);
  else
    fill<double>(s, rays, to, arena);
}

}  // namespace

NodeType nodes::trace_intersect() {
  return pixel_node("trace.intersect", prepare, tile)
      .doc("Finds the face that each ray meets first; ties go to the lowest face, whatever the tree.")
      .cite("Woop, Benthin & Wald 2013, Watertight ray/triangle intersection, JCGT 2(1)")
      .cite(
          "Wald 2007, On fast construction of SAH-based bounding volume hierarchies, "
          "doi:10.1109/RT.2007.4342588")
      .covers(74)
      .input("rays", &Inputs::rays, "Rays, as trace.camera makes them.")
      .input("mesh", &Inputs::mesh, "What they may meet; neither culled nor clipped.",
             {.space = {Space::object, Space::world}})
      .output(
          "hits", &Outputs::hits,
          "id; t, in lengths of the ray's D; u and v, the weights of the face's second and third corner.");
}

}  // namespace frustum
