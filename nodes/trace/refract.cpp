#include "nodes/trace/refract.h"

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
struct Params {
  double inside = 1.5, outside = 1;
};
struct Outputs {
  Tiled<Image> rays, reflectance;
};

struct State {
  RayReader rays;
  SurfaceReader points;
  double inside, outside;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame &points = in.points.frame(), &rays = in.rays.frame();
  if (points.window != rays.window || points.samples() != rays.samples())
    throw NodeError("different_frames", "rays and points have different windows or samples",
                    at_input("points"));
  const PlaneKind real = real_kind(ctx.precision);
  Frame bent{.window = points.window, .pattern = points.pattern, .planes = ray_planes(real)};
  Frame share{.window = points.window, .pattern = points.pattern, .planes = {{"Y", real}}};
  return {{RayReader(in.rays, true), SurfaceReader(in.points, in.mesh, ctx.precision), p.inside, p.outside},
          {std::move(bent), std::move(share)}};
}

template <class R>
void fill(const State& s, const Tile& rays, const Tile& points, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile &bent = out[&Outputs::rays], &share = out[&Outputs::reflectance];
  const Rect& rect = rays.rect();
  const auto n = static_cast<std::size_t>(rect.width());
  const std::span<double> of_rays = arena.take<double>(RayReader::scratch(n)),
                          of_points = arena.take<double>(SurfaceReader::scratch(n));
  for (int k = 0; k < rays.samples(); ++k)
    for (int y = rect.y0; y < rect.y1; ++y) {
      const RayReader::Rows in = s.rays.rows(rays, k, y, of_rays);
      const SurfaceReader::Rows at = s.points.rows(points, k, y, of_points);
      const RayWriter<R> to = bent.empty() ? RayWriter<R>() : RayWriter<R>(bent, k, y);
      R* const reflectance = share.empty() ? nullptr : out_row<R>(share, 0, k, y);
      for (std::size_t x = 0; x < n; ++x) {
        const auto point = at.point(x);
        const trace::Bent beam = point ? trace::bent(in.beam(x), *point, s.outside, s.inside) : trace::Bent{};
        if (reflectance != nullptr) reflectance[x] = static_cast<R>(beam.reflectance);
        if (beam.beam)
          to.put(x, *beam.beam, point->slack);
        else
          to.put_none(x);
      }
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& shape = out[&Outputs::rays].empty() ? out[&Outputs::reflectance] : out[&Outputs::rays];
  const Tile rays = in[&Inputs::rays].part(shape.rect()), points = in[&Inputs::points].part(shape.rect());
  if (shape.frame().planes[0].kind == PlaneKind::f32)
    fill<float>(s, rays, points, out, arena);
  else
    fill<double>(s, rays, points, out, arena);
}

}  // namespace

NodeType nodes::trace_refract() {
  return pixel_node("trace.refract", prepare, tile)
      .doc("Bends each ray where it met a surface, and says which share of its light is mirrored instead.")
      .cite("Born & Wolf, Principles of Optics, 1.5.2 (Snell, Fresnel)")
      .cite("Igehy 1999, Tracing ray differentials, doi:10.1145/311535.311555")
      .covers(78)
      .input("rays", &Inputs::rays, "The rays that came.")
      .input("points", &Inputs::points,
             "Where they met the mesh: id, P and N; without N the faces' own normals.")
      .input("mesh", &Inputs::mesh, "The mesh that was met, or drawn; its fronts face the outside.")
      .param("inside", &Params::inside,
             "Index of refraction behind the fronts; raising it bends more: water 1.33, glass 1.5.",
             {.range = above(0)})
      .param("outside", &Params::outside, "Index of refraction before them.", {.range = above(0)})
      .output("rays", &Outputs::rays, "What gets through; no ray where all is mirrored or nothing was met.")
      .output("reflectance", &Outputs::reflectance,
              "Y: the share that is mirrored, of unpolarised light; 1 where all is, 0 where nothing was met.")
      .blank_where(&Inputs::points);
}

}  // namespace frustum
