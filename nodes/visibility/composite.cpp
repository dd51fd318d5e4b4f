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
    for (double*& row : sum_) row = arena.take<double>(n_).data();
    for (auto& row : wide_) row = arena.take<R>(n_);
  }

  void fill() {
    for (int sample = 0; sample < out_.samples(); ++sample)
      for (int y = out_.rect().y0; y < out_.rect().y1; ++y) {
        if (s_.one)
          pass(sample, y);
        else
          composite(sample, y);
      }
  }

 private:
  const R* row(std::size_t channel, int sample, int y) {
    return real_row<R>(in_, s_.planes[channel], sample, y, wide_[channel]);
  }
  void pass(int sample, int y) {
    for (std::size_t c = 0; c < 4; ++c)
      if (R* to = out_row<R>(out_, static_cast<int>(c), sample, y)) std::copy_n(row(c, sample, y), n_, to);
  }
  void composite(int sample, int y) {
    std::fill_n(sum_[0], n_, 1.0);
    for (std::size_t c = 0; c < 4; ++c) std::fill_n(sum_[c + 1], n_, 0.0);
    const kernels::CompositeSums sums{n_, sum_[0], sum_[1], sum_[2], sum_[3], sum_[4]};
    for (int layer = 0; layer < s_.layers; ++layer) {
      const int k = layer * out_.samples() + sample;
      if (!compositing::put_row_behind<R>(row(0, k, y), row(1, k, y), row(2, k, y), row(3, k, y), sums))
        break;
    }
    for (std::size_t c = 0; c < 4; ++c)
      if (R* to = out_row<R>(out_, static_cast<int>(c), sample, y))
        for (std::size_t x = 0; x < n_; ++x) to[x] = static_cast<R>(sum_[c + 1][x]);
  }

  const State& s_;
  const Tile in_, &out_;
  std::size_t n_;
  std::array<double*, 5> sum_{};  // what comes through, then the channels
  std::array<std::span<R>, 4> wide_;
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
