#include "nodes/rasterize/triangles.h"

#include <fmt/format.h>

#include "nodes/rasterize.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/pattern.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

using kernels::PlaneView;

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {};
struct Outputs {
  Tiled<Visibility> visibility;
  Tiled<Depth> depth;
};

template <class R>
struct Filler {
  Ref<Mesh> mesh;
  Ref<Column> position;
  Ref<SamplePattern> pattern;
  TriangleRasterizer<R> rasterizer;
};
using State = std::variant<Filler<float>, Filler<double>>;

Rect window_of(const Mesh& mesh) {
  if (!mesh.camera)
    throw NodeError("no_camera", "the mesh has passed no projection, so its picture has no resolution",
                    at_input("mesh"));
  const glm::ivec2 size = mesh.camera->resolution;
  constexpr int limit = 65536;
  if (size.x > limit || size.y > limit)
    throw NodeError("too_large", fmt::format("the picture is {} x {} pixels; at most {} x {} can be drawn",
                                             size.x, size.y, limit, limit));
  return {0, 0, size.x, size.y};
}

kernels::SamplePositions positions_of(const SamplePattern* pattern) {
  if (pattern == nullptr) return kernels::centre_sample();
  return {pattern->samples, pattern->period, pattern->x, pattern->y};
}

std::span<const std::uint32_t> origins_of(const Mesh& mesh) {
  const Column* origin = mesh.find("origin");
  return origin != nullptr ? origin->values<std::uint32_t>() : std::span<const std::uint32_t>();
}

template <class R>
Filler<R> make_filler(const Inputs& in, Rect window, Context& ctx) {
  Ref<Column> position = in.mesh->real<R>("position");
  Ref<SamplePattern> pattern = in.pattern.value_or(nullptr);
  const kernels::ScreenMesh<R> screen{position->values<glm::vec<4, R>>(), in.mesh->triangles(),
                                      origins_of(*in.mesh)};
  const auto order =
      in.mesh->camera->reversed_z ? kernels::DepthOrder::reversed : kernels::DepthOrder::standard;
  TriangleRasterizer<R> rasterizer(screen, positions_of(pattern.get()),
                                   {window.x0, window.y0, window.x1, window.y1}, order,
                                   [&ctx](std::uint64_t bytes) { ctx.claim(bytes); });
  return {in.mesh, std::move(position), std::move(pattern), std::move(rasterizer)};
}

void report(const kernels::TriangleBins& bins, Context& ctx) {
  ctx.count("triangle_bin_pairs", bins.entries.size());
  ctx.count("triangles_without_area", bins.without_area);
  ctx.count("triangles_out_of_range", bins.out_of_range);
  if (bins.out_of_range > 0)
    ctx.warn("triangles_out_of_range",
             fmt::format(
                 "{} triangles with a corner that is NaN, infinite or more than 2^21 px away were left out",
                 bins.out_of_range));
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Rect window = window_of(*in.mesh);
  return ctx.real([&]<class R>() -> Prepared<State, Outputs> {
    Filler<R> filler = make_filler<R>(in, window, ctx);
    report(filler.rasterizer.bins(), ctx);
    const Plane z{"Z", plane_kind_of<R>};
    Frame visibility{window, filler.pattern, {{"id", PlaneKind::u32}, z}};
    Frame depth{window, filler.pattern, {z}};
    return {std::move(filler), {std::move(visibility), std::move(depth)}};
  });
}

// A plane of the tile, or memory in its place where nobody reads it.
template <class T>
PlaneView<T> plane_or_scratch(const Tile& tile, int plane, const Tile& shape, Arena& arena) {
  const Rect& rect = shape.rect();
  if (!tile.empty() && tile.has(plane))
    return {tile.row<T>(plane, 0, rect.y0), tile.row_stride(), tile.sample_stride()};
  const std::ptrdiff_t row = padded_row(rect.width()), sample = row * rect.height();
  return {arena.take<T>(static_cast<std::size_t>(sample * shape.samples())).data(), row, sample};
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile &visibility = out[&Outputs::visibility], &depth = out[&Outputs::depth];
  const Tile& shape = visibility.empty() ? depth : visibility;
  const Rect& r = shape.rect();
  std::visit(
      [&]<class R>(const Filler<R>& filler) {
        const bool into_depth = visibility.empty() || !visibility.has(1);
        const PlaneView<R> z =
            plane_or_scratch<R>(into_depth ? depth : visibility, into_depth ? 0 : 1, shape, arena);
        filler.rasterizer.fill({r.x0, r.y0, r.x1, r.y1},
                               plane_or_scratch<std::uint32_t>(visibility, 0, shape, arena), z);
        if (into_depth || depth.empty() || !depth.has(0)) return;
        for (int s = 0; s < shape.samples(); ++s)
          for (int y = r.y0; y < r.y1; ++y) std::copy_n(z.row(s, y - r.y0), r.width(), depth.row<R>(0, s, y));
      },
      state);
}

}  // namespace

NodeType nodes::rasterize_triangles() {
  return pixel_node("rasterize.triangles", prepare, tile)
      .doc("Finds the nearest face at every sample, by exact coverage and a depth buffer.")
      .cite("Pineda 1988, A Parallel Algorithm for Polygon Rasterization, doi:10.1145/54852.378457")
      .cite(
          "Catmull 1974, A Subdivision Algorithm for Computer Display of Curved Surfaces (the depth buffer)")
      .covers(40)
      .input("mesh", &Inputs::mesh,
             "Triangles of either winding; samples of a closed mesh are covered exactly once.",
             {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .output("visibility", &Outputs::visibility,
              "The face and the depth at each sample; ties go to the lowest source.")
      .output("depth", &Outputs::depth, "The depth alone; where nothing is seen, that of the far plane.");
}

}  // namespace frustum
