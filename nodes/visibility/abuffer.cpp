#include "nodes/visibility/abuffer.h"

#include "nodes/visibility.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/screen_view.h"
#include "runtime/buffers/texture.h"
#include "runtime/buffers/transparency.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

using kernels::PlaneView;

constexpr std::string_view hiding_name = "hidden_by_opaque";
// Samples and layers of one pixel; beyond it rows of numbers no longer fit any cache.
constexpr std::uint64_t most_in_a_pixel = 1 << 16;

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
  std::optional<Ref<Material>> material;
  std::optional<Ref<Texture>> texture;
};
struct Params {
  std::optional<int> max_layers = {};
};
struct Outputs {
  Tiled<Visibility> layers;
};

template <class R>
struct Filler {
  ScreenView<R> view;
  Ref<SamplePattern> pattern;
  std::vector<std::uint8_t> hides = {};
  int layers = 1;
  std::optional<LayerRasterizer<R>> rasterizer = {};
};
using State = std::variant<Filler<float>, Filler<double>>;

std::vector<std::uint8_t> faces_that_hide(const Inputs& in) {
  return opaque_faces(*in.mesh, in.material ? in.material->get() : nullptr,
                      in.texture ? in.texture->get() : nullptr);
}

Verdict hiding(const Inputs& in, const Params&, const Context&) {
  const std::vector<std::uint8_t> opaque = faces_that_hide(in);
  const auto faces = static_cast<std::uint64_t>(std::count(opaque.begin(), opaque.end(), 1));
  if (faces == 0) return off_exact("no face is opaque: every fragment shows", in.mesh->faces());
  return on(fmt::format("{} of {} faces are opaque", faces, in.mesh->faces()), in.mesh->faces());
}

void report(const kernels::TriangleBins& bins, const kernels::FragmentCounts& counts, int layers,
            Context& ctx) {
  ctx.count("triangle_bin_pairs", bins.entries.size());
  ctx.count("triangles_without_area", bins.without_area);
  ctx.count("triangles_out_of_range", bins.out_of_range);
  ctx.count("fragments", counts.fragments);
  ctx.count("fragments_dropped", counts.beyond);
  ctx.count("layers", static_cast<std::uint64_t>(layers));
  if (bins.out_of_range > 0)
    ctx.warn("triangles_out_of_range",
             fmt::format(
                 "{} triangles with a corner that is NaN, infinite or more than 2^21 px away were left out",
                 bins.out_of_range));
  if (counts.beyond > 0)
    ctx.warn("fragments_dropped",
             fmt::format("{} of {} fragments lie behind the {} layers that max_layers keeps; all need {}",
                         counts.beyond, counts.fragments, layers, counts.most));
}

int layers_of(const kernels::FragmentCounts& counts, const Params& p, int samples) {
  const std::uint32_t wanted = std::max(counts.most, 1u);
  const std::uint32_t layers =
      p.max_layers ? std::min(wanted, static_cast<std::uint32_t>(*p.max_layers)) : wanted;
  if (std::uint64_t{layers} * static_cast<std::uint64_t>(samples) > most_in_a_pixel)
    throw NodeError(
        "too_many_layers",
        fmt::format("{} layers of {} samples are more than {} a pixel: keep the nearest with max_layers",
                    layers, samples, most_in_a_pixel),
        at_param("max_layers"));
  return static_cast<int>(layers);
}

// The samples of a pixel once for each layer; none stays none where there is one layer of one.
Ref<SamplePattern> layered(const Ref<SamplePattern>& pattern, int layers, Context& ctx) {
  if (layers == 1) return pattern;
  const SamplePattern one = pattern ? *pattern : SamplePattern{};
  ctx.claim(2 * one.x.size() * sizeof(std::uint16_t) * static_cast<std::uint64_t>(layers));
  return std::make_shared<const SamplePattern>(
      SamplePattern{one.samples * layers, one.period, repeated(one.x, layers), repeated(one.y, layers)});
}

template <class R>
std::pair<Filler<R>, Frame> make_filler(const Inputs& in, const Params& p, Rect window, Context& ctx) {
  Filler<R> f{.view = ScreenView<R>(in.mesh), .pattern = in.pattern.value_or(nullptr)};
  if (ctx.simulates(hiding_name)) f.hides = faces_that_hide(in);
  ctx.claim(f.hides.size());
  const LayerRasterizer<R>& r =
      f.rasterizer.emplace(f.view.triangles(), sample_positions(f.pattern.get()), pixel_rect(window),
                           depth_order(*in.mesh), f.hides, [&ctx](std::uint64_t bytes) { ctx.claim(bytes); });
  const auto limit = static_cast<std::uint32_t>(p.max_layers.value_or(std::numeric_limits<int>::max()));
  const kernels::FragmentCounts counts = r.count(limit, [&ctx] { ctx.poll(); });
  f.layers = layers_of(counts, p, r.samples());
  report(r.bins(), counts, f.layers, ctx);
  Frame frame{window, layered(f.pattern, f.layers, ctx), {{"id", PlaneKind::u32}, {"Z", plane_kind_of<R>}}};
  return {std::move(f), std::move(frame)};
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Rect window = picture_window(*in.mesh);
  return ctx.real([&]<class R>() -> Prepared<State, Outputs> {
    auto [filler, frame] = make_filler<R>(in, p, window, ctx);
    return {std::move(filler), {std::move(frame)}};
  });
}

// A plane of the tile, or memory in its place where nobody reads it.
template <class T>
PlaneView<T> plane_or_scratch(const Tile& tile, int plane, Arena& arena) {
  const Rect& rect = tile.rect();
  if (tile.has(plane)) return {tile.row<T>(plane, 0, rect.y0), tile.row_stride(), tile.sample_stride()};
  const std::ptrdiff_t row = padded_row(rect.width()), sample = row * rect.height();
  return {arena.take<T>(static_cast<std::size_t>(sample * tile.samples())).data(), row, sample};
}

template <class R>
void fill(const Filler<R>& f, const Tile& out, Arena& arena) {
  const Rect& r = out.rect();
  const auto width = static_cast<std::size_t>(r.width());
  const auto pixels = static_cast<std::size_t>(r.area()) * static_cast<std::size_t>(f.rasterizer->samples());
  const kernels::FragmentLayers<R> layers{plane_or_scratch<std::uint32_t>(out, 0, arena),
                                          plane_or_scratch<R>(out, 1, arena), f.layers};
  const kernels::FragmentScratch<R> scratch{arena.take<std::uint32_t>(pixels).data(),
                                            f.hides.empty() ? nullptr : arena.take<R>(pixels).data(),
                                            arena.take<R>(width).data()};
  f.rasterizer->fill({r.x0, r.y0, r.x1, r.y1}, layers, scratch);
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  std::visit([&](const auto& filler) { fill(filler, out[&Outputs::layers], arena); }, state);
}

Rect seen(const State& state, Rect rect) {
  return std::visit([&](const auto& filler) { return seen_part(filler.rasterizer->bins(), rect); }, state);
}

}  // namespace

NodeType nodes::visibility_abuffer() {
  return pixel_node("visibility.abuffer", prepare, tile)
      .doc(
          "Finds every face at every sample, in the order of their depths: the fragment lists of an "
          "A-buffer.")
      .cite("Carpenter 1984, The A-buffer, an antialiased hidden surface method, doi:10.1145/800031.808585")
      .covers(42)
      .input("mesh", &Inputs::mesh,
             "Triangles of either winding; column transparency, textures and vertex colours say which let "
             "others "
             "show.",
             {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .input("material", &Inputs::material,
             "The material that shading takes for everything, instead of the mesh's own: its texture may "
             "have holes.")
      .input("texture", &Inputs::texture,
             "The texture that shading takes for everything, instead of the materials' own and the vertex "
             "colours.")
      .param("max_layers", &Params::max_layers,
             "Keeps the nearest so many fragments of a sample; null keeps all. Raising it costs memory and "
             "time.",
             {.range = at_least(1)})
      .knob({"1", "2", "4", "8", "16", "64"},
            "What lies behind n layers of opacity a is left out: error (1 - a)^n.")
      .output(
          "layers", &Outputs::layers,
          "Face and depth by layer: sample l * samples + s is the l-th fragment at sample s; ties by source.")
      .shortcut(hiding_name, hiding,
                "Fragments behind an opaque one are left out: nothing of them would show.",
                {"face", 3})  // tests/bench/effects_bench.cpp, one thread: to find out that no face is opaque
      .seen(seen);
}

}  // namespace frustum
