#include "nodes/visibility/composite.h"

#include "nodes/visibility.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/pattern.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

constexpr std::string_view transparency_name = "transparency";
constexpr std::array<const char*, 4> channels{"R", "G", "B", "A"};

struct Inputs {
  Tiled<Image> image;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  Precision precision;
  std::array<RealPlane, 4> planes{};
  int layers = 1;
  bool one = false;  // the first layer is all there is
};

bool repeats(std::span<const std::uint16_t> layers, std::span<const std::uint16_t> one) {
  for (std::size_t i = 0; i < layers.size(); i += one.size())
    if (!std::equal(one.begin(), one.end(), layers.begin() + static_cast<std::ptrdiff_t>(i))) return false;
  return true;
}

// How many times the samples of the picture repeat those of the pattern; 0 where they do not.
int layers_of(const Inputs& in) {
  static const SamplePattern centre;
  const Frame& from = in.image.frame();
  const SamplePattern& one = in.pattern ? **in.pattern : centre;
  const SamplePattern& all = from.pattern ? *from.pattern : centre;
  const bool fits = all.samples % one.samples == 0 && all.period == one.period;
  return fits && repeats(all.x, one.x) && repeats(all.y, one.y) ? all.samples / one.samples : 0;
}

Verdict transparency(const Inputs& in, const Params&, const Context&) {
  const int layers = layers_of(in);
  const Frame& from = in.image.frame();
  const auto samples =
      static_cast<std::uint64_t>(from.window.area()) * static_cast<std::uint64_t>(from.samples());
  if (layers == 1) return off_exact("there is one layer: nothing lies behind what is seen", samples);
  return on(fmt::format("some sample has {} layers", layers), samples);
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Frame& from = in.image.frame();
  const int layers = layers_of(in);
  if (layers == 0)
    throw NodeError(
        "wrong_pattern",
        fmt::format("the {} samples of a pixel are not those of the pattern's {}, layer by layer: link the "
                    "pattern that visibility.abuffer has",
                    from.samples(), in.pattern ? (*in.pattern)->samples : 1),
        at_input("pattern"));
  State s{.precision = ctx.precision, .layers = layers, .one = !ctx.simulates(transparency_name)};
  for (std::size_t c = 0; c < 4; ++c) s.planes[c] = read_real(in.image, channels[c], ctx.precision);
  const PlaneKind kind = real_kind(ctx.precision);
  Frame to{.window = from.window,
           .pattern = in.pattern.value_or(nullptr),
           .planes = {{"R", kind}, {"G", kind}, {"B", kind}, {"A", kind}},
           .color_space = from.color_space,
           .alpha = Alpha::premultiplied};
  return {std::move(s), {std::move(to)}};
}

template <class R>
class Filler {
 public:
  Filler(const State& s, const Tile& in, const Tile& out, Arena& arena)
      : s_(s), in_(in), out_(out), n_(static_cast<std::size_t>(out.rect().width())) {
    const bool widens = std::any_of(s.planes.begin(), s.planes.end(),
                                    [](const RealPlane& p) { return p.kind != plane_kind_of<R>; });
    for (auto& rows : wide_)
      if (widens) rows = arena.take<R>(n_ * static_cast<std::size_t>(s.layers));
  }

  void fill() {
    for (int sample = 0; sample < out_.samples(); ++sample)
      for (int y = out_.rect().y0; y < out_.rect().y1; ++y) {
        if (s_.one)
          pass(sample, y);
        else
          compositing::composite_row<R>(layers(sample, y), n_, out_rows(sample, y));
      }
  }

 private:
  std::array<R*, 4> out_rows(int sample, int y) const {
    return {out_row<R>(out_, 0, sample, y), out_row<R>(out_, 1, sample, y), out_row<R>(out_, 2, sample, y),
            out_row<R>(out_, 3, sample, y)};
  }
  void pass(int sample, int y) {
    const std::array<R*, 4> out = out_rows(sample, y);
    for (std::size_t c = 0; c < 4; ++c)
      if (out[c] != nullptr) std::copy_n(real_row<R>(in_, s_.planes[c], sample, y, wide_[c]), n_, out[c]);
  }
  // All layers of a row: the picture's own, or widened.
  kernels::LayerRows<R> layers(int sample, int y) {
    kernels::LayerRows<R> rows{.first = {}, .stride = {}, .layers = s_.layers};
    for (std::size_t c = 0; c < 4; ++c) {
      rows.first[c] = real_row<R>(in_, s_.planes[c], sample, y, wide_[c]);
      rows.stride[c] = in_.sample_stride() * out_.samples();
      if (s_.planes[c].kind == plane_kind_of<R>) continue;
      rows.stride[c] = static_cast<std::ptrdiff_t>(n_);
      for (int layer = 1; layer < s_.layers; ++layer)
        real_row<R>(in_, s_.planes[c], layer * out_.samples() + sample, y,
                    wide_[c].subspan(static_cast<std::size_t>(layer) * n_));
    }
    return rows;
  }

  const State& s_;
  const Tile in_, &out_;
  std::size_t n_;
  std::array<std::span<R>, 4> wide_;  // by channel a row a layer
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::image];
  const Tile from = in[&Inputs::image].part(to.rect());
  if (s.precision == Precision::single)
    Filler<float>(s, from, to, arena).fill();
  else
    Filler<double>(s, from, to, arena).fill();
}

}  // namespace

NodeType nodes::visibility_composite() {
  return pixel_node("visibility.composite", prepare, tile)
      .doc("Puts the layers of each sample over one another, from the front to the back.")
      .cite("Porter & Duff 1984, Compositing digital images, doi:10.1145/964965.808606")
      .cite("Carpenter 1984, The A-buffer, an antialiased hidden surface method, doi:10.1145/800031.808585")
      .covers(42)
      .input("image", &Inputs::image,
             "Colours of the layers of visibility.abuffer: R, G, B, premultiplied by A.")
      .input("pattern", &Inputs::pattern,
             "The pattern that visibility.abuffer has; left out: one sample a pixel.")
      .output("image", &Outputs::image, "One colour a sample, premultiplied; 0 where nothing is.")
      .effect(transparency_name, transparency, "What lies behind the nearest face shines through.",
              {"sample", 15})  // tests/bench/effects_bench.cpp, one thread, shared with others: 11 to 24
      .blank_where(&Inputs::image);
}

}  // namespace frustum
