#include "nodes/rasterize/triangles.h"

#include <fmt/format.h>

#include "nodes/rasterize.h"
#include "runtime/buffers/face_finder.h"
#include "runtime/buffers/transparency.h"

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {};
struct Outputs {
  Tiled<Visibility> visibility;
  Tiled<Depth> depth;
};

using State = FaceFinders<TriangleRasterizer<float>, TriangleRasterizer<double>>;

constexpr std::string_view transparency_name = "transparency",
                           one_is_kept =
                               "only the nearest face is kept at a sample; visibility.abuffer keeps all";

// The first face through which others show; null where all are opaque.
std::optional<std::size_t> see_through(const Mesh& mesh) {
  const std::vector<std::uint8_t> opaque = opaque_faces(mesh);
  if (opaque.empty()) return mesh.faces() == 0 ? std::nullopt : std::optional<std::size_t>(0);
  const auto at = std::find(opaque.begin(), opaque.end(), 0);
  return at == opaque.end() ? std::nullopt : std::optional<std::size_t>(at - opaque.begin());
}

Verdict transparency(const Inputs& in, const Params&, const Context&) {
  if (const auto face = see_through(*in.mesh))
    return absent(fmt::format("face {} is not opaque, and {}", *face, one_is_kept));
  return off_exact("every face is opaque");
}

void report(const kernels::TriangleBins& bins, const Mesh& mesh, Context& ctx) {
  if (const auto face = see_through(mesh))
    ctx.warn(
        "nothing_shows_through",
        fmt::format("face {} is not opaque, but what lies behind it is left out: {}", *face, one_is_kept));
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
  return prepare_finder<State, Outputs>(in, ctx, [&]<class R>(const FinderScene<R>& s) {
    TriangleRasterizer<R> rasterizer(s.mesh, s.pattern, s.window, s.order, s.claim);
    report(rasterizer.bins(), *in.mesh, ctx);
    return rasterizer;
  });
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  fill_faces(state, out, arena);
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
      .effect(transparency_name, transparency, "What lies behind shines through faces that are not opaque.")
      .output("visibility", &Outputs::visibility,
              "The face and the depth at each sample; ties go to the lowest source.")
      .output("depth", &Outputs::depth, "The depth alone; where nothing is seen, that of the far plane.")
      .seen(seen_faces<State>);
}

}  // namespace frustum
