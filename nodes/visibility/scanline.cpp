#include "nodes/visibility/scanline.h"

#include "nodes/visibility.h"
#include "runtime/buffers/face_finder.h"

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

using State = FaceFinders<scanline::Scanner<float>, scanline::Scanner<double>>;

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  return prepare_finder<State, Outputs>(in, ctx, [&]<class R>(const FinderScene<R>& s) {
    scanline::Scanner<R> scanner(s.mesh, s.pattern, s.window, s.order, s.claim);
    ctx.count("triangle_bin_pairs", scanner.bins().entries.size());
    return scanner;
  });
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  fill_faces(state, out, arena);
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
      .output("depth", &Outputs::depth, "The depth alone; where nothing is seen, that of the far plane.")
      .seen(seen_faces<State>);
}

}  // namespace frustum
