#include "nodes/visibility/scanline.h"

#include "nodes/visibility.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/core/node_type.h"

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

template <class R>
struct Lines {
  ScreenView<R> view;
  Ref<SamplePattern> pattern;
  scanline::Scanner<R> scanner;
};
using State = std::variant<Lines<float>, Lines<double>>;

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Rect window = picture_window(*in.mesh);
  return ctx.real([&]<class R>() -> Prepared<State, Outputs> {
    ScreenView<R> view(in.mesh);
    Ref<SamplePattern> pattern = in.pattern.value_or(nullptr);
    scanline::Scanner<R> scanner(view.triangles(), sample_positions(pattern.get()), pixel_rect(window),
                                 depth_order(*in.mesh), [&ctx](std::uint64_t bytes) { ctx.claim(bytes); });
    ctx.count("triangle_bin_pairs", scanner.bins().entries.size());
    Frame visibility = visibility_frame<R>(window, pattern), depth = depth_frame<R>(window, pattern);
    return {Lines<R>{std::move(view), std::move(pattern), std::move(scanner)},
            {std::move(visibility), std::move(depth)}};
  });
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  std::visit(
      [&]<class R>(const Lines<R>& lines) {
        fill_visibility<R>(out[&Outputs::visibility], out[&Outputs::depth], arena,
                           [&](kernels::PixelRect rect, kernels::PlaneView<std::uint32_t> id,
                               kernels::PlaneView<R> z) { lines.scanner.fill(rect, id, z); });
      },
      state);
}

}  // namespace

NodeType nodes::visibility_scanline() {
  return pixel_node("visibility.scanline", prepare, tile)
      .doc("Finds the nearest face at every sample line by line, comparing depths only where spans overlap.")
      .cite("Watkins 1970, A Real Time Visible Surface Algorithm, University of Utah UTEC-CSc-70-101")
      .covers(47)
      .input("mesh", &Inputs::mesh, "Opaque triangles of either winding, as rasterize.triangles takes them.",
             {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .output("visibility", &Outputs::visibility,
              "The face and the depth at each sample: the bytes of rasterize.triangles.")
      .output("depth", &Outputs::depth, "The depth alone; where nothing is seen, that of the far plane.");
}

}  // namespace frustum
