#include "nodes/trace/reflect.h"

#include "nodes/trace.h"
#include "runtime/buffers/rays.h"
#include "runtime/buffers/surface_points.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> rays, points;
  Ref<Mesh> mesh;
};
struct Params {};
struct Outputs {
  Tiled<Image> rays;
};

struct State {
  RayReader rays;
  SurfaceReader points;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Frame &points = in.points.frame(), &rays = in.rays.frame();
  if (points.window != rays.window || points.samples() != rays.samples())
    throw NodeError("different_frames", "rays and points have different windows or samples",
                    at_input("points"));
  Frame frame{
      .window = points.window, .pattern = points.pattern, .planes = ray_planes(real_kind(ctx.precision))};
  return {{RayReader(in.rays, true), SurfaceReader(in.points, in.mesh, ctx.precision)}, {std::move(frame)}};
}

template <class R>
void fill(const State& s, const Tile& rays, const Tile& points, const Tile& to, Arena& arena) {
  const auto n = static_cast<std::size_t>(to.rect().width());
  const std::span<double> of_rays = arena.take<double>(RayReader::scratch(n)),
                          of_points = arena.take<double>(SurfaceReader::scratch(n));
  for (int k = 0; k < to.samples(); ++k)
    for (int y = to.rect().y0; y < to.rect().y1; ++y) {
      const RayReader::Rows in = s.rays.rows(rays, k, y, of_rays);
      const SurfaceReader::Rows at = s.points.rows(points, k, y, of_points);
      const RayWriter<R> out(to, k, y);
      for (std::size_t x = 0; x < n; ++x) {
        const auto point = at.point(x);
        const auto beam = point ? trace::mirrored(in.beam(x), *point) : std::nullopt;
        if (beam)
          out.put(x, *beam, point->slack);
        else
          out.put_none(x);
      }
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::rays];
  const Tile rays = in[&Inputs::rays].part(to.rect()), points = in[&Inputs::points].part(to.rect());
  if (to.frame().planes[0].kind == PlaneKind::f32)
    fill<float>(s, rays, points, to, arena);
  else
    fill<double>(s, rays, points, to, arena);
}

}  // namespace

NodeType nodes::trace_reflect() {
  return pixel_node("trace.reflect", prepare, tile)
      .doc("Sends each ray on from the point it met, as a mirror does.")
      .cite("Whitted 1980, An improved illumination model for shaded display, doi:10.1145/358876.358882")
      .cite("Igehy 1999, Tracing ray differentials, doi:10.1145/311535.311555")
      .covers(77)
      .input("rays", &Inputs::rays, "The rays that came.")
      .input("points", &Inputs::points,
             "Where they met the mesh: id, P and N; without N the faces' own normals.")
      .input("mesh", &Inputs::mesh, "The mesh that was met, or drawn: it has world positions in any space.")
      .output("rays", &Outputs::rays, "What is mirrored; no ray where nothing was met.")
      .blank_where(&Inputs::points);
}

}  // namespace frustum
