#include "nodes/supersample/resolve.h"

#include "nodes/supersample.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

using namespace resolving;
using kernels::FilterKind;
using kernels::ResolveWeights;

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  FilterKind filter = FilterKind::mitchell;
  std::optional<double> radius = {};
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  std::variant<ResolveWeights<float>, ResolveWeights<double>> weights;
  Rect window;
  int margin = 0;
  std::vector<RealPlane> planes = {};  // those of the output, in its order
  bool copies = false;                 // some are stored in another precision
  bool weighs_all = false;             // forced: also where the result is known
  bool passes = false;                 // every pixel is its one sample
};

// One sample a pixel and a filter that reaches no neighbour: the weighted mean of one number.
Verdict reconstruction(const Inputs& in, const Params& p, const Context&) {
  const Frame& from = in.image.frame();
  const double radius = p.radius.value_or(usual_radius(p.filter));
  const auto numbers = static_cast<std::uint64_t>(from.window.area()) *
                       static_cast<std::uint64_t>(from.samples()) * from.planes.size();
  if (from.samples() > 1)
    return on(fmt::format("{} samples a pixel, where they are not all equal", from.samples()), numbers);
  if (radius <= 0.5) return off_exact("one sample a pixel, and the filter reaches no other", numbers);
  return on(fmt::format("the filter reaches {:.3g} px, where the pixels are not all equal", radius), numbers);
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  static const SamplePattern centre;
  const SamplePattern& pattern = from.pattern ? *from.pattern : centre;
  const kernels::Filter filter{.kind = p.filter, .radius = p.radius.value_or(usual_radius(p.filter))};
  Frame to = from;
  to.pattern = nullptr;
  to.planes.clear();
  std::vector<RealPlane> planes;
  for (const Plane& plane : from.planes) {
    if (plane.kind == PlaneKind::u32) continue;
    planes.push_back(read_real(in.image, plane.name, ctx.precision));
    to.planes.push_back({plane.name, real_kind(ctx.precision)});
  }
  State s = ctx.real([&]<class R>() {
    ctx.claim(ResolveWeights<R>::bytes(filter, pattern.samples, pattern.period));
    ResolveWeights<R> weights(filter, pattern.samples, pattern.period, pattern.x, pattern.y);
    const int margin = weights.margin();
    return State{std::move(weights), from.window, margin};
  });
  for (const RealPlane& plane : planes) s.copies = s.copies || plane.kind != real_kind(ctx.precision);
  s.planes = std::move(planes);
  s.weighs_all = ctx.forces("reconstruction");
  s.passes = !ctx.simulates("reconstruction");
  return {std::move(s), {std::move(to)}};
}

Rect reads(const State& s, std::string_view, Rect rect) { return rect.grown(s.margin); }

template <class R>
class Filler {
 public:
  Filler(const State& s, const Tile& in, const Tile& out, Arena& arena)
      : s_(s),
        weights_(std::get<ResolveWeights<R>>(s.weights)),
        m_(s.margin),
        out_(out),
        rect_(out.rect()),
        read_(intersection(rect_.grown(m_), s.window)),
        in_(in.part(read_)),
        arena_(arena),
        n_(static_cast<std::size_t>(rect_.width())) {}

  void fill() {
    for (std::size_t p = 0; p < s_.planes.size(); ++p) {
      if (!out_.has(static_cast<int>(p))) continue;
      const Source& source = sources_.emplace_back(gather(static_cast<int>(p)));
      flat_.push_back(s_.passes ? std::span<std::uint32_t>() : find_flat(source));
      wanted_.push_back(static_cast<int>(p));
    }
    std::vector<const R*> in(wanted_.size());
    std::vector<const std::uint32_t*> flat(wanted_.size());
    std::vector<R*> to(wanted_.size());
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      for (std::size_t i = 0; i < wanted_.size(); ++i) {
        in[i] = sources_[i].at(rect_.x0 - read_.x0, y - read_.y0);
        if (!s_.passes) flat[i] = flat_[i].data() + static_cast<std::size_t>(y - rect_.y0) * n_;
        to[i] = out_.row<R>(wanted_[i], 0, y);
      }
      if (wanted_.empty()) return;
      // Every plane lies the same way: all are the tile's own, or all are copies of the same shape.
      const kernels::ResolveRow<R> row{.x0 = rect_.x0,
                                       .y = y,
                                       .n = n_,
                                       .left = s_.window.x0 - rect_.x0,
                                       .right = s_.window.x1 - rect_.x0,
                                       .top = s_.window.y0 - y,
                                       .bottom = s_.window.y1 - y,
                                       .in = in,
                                       .sample_stride = sources_[0].sample_stride,
                                       .row_stride = sources_[0].row_stride,
                                       .flat = flat,
                                       .out = to};
      if (s_.passes)
        for (std::size_t i = 0; i < in.size(); ++i) std::copy_n(in[i], n_, to[i]);
      else if (s_.weighs_all)
        weigh_all(row);
      else
        resolving::resolve_row<R>(weights_, row);
    }
  }

 private:
  // Weighs where all samples are equal too, and then takes what they are equal to.
  void weigh_all(kernels::ResolveRow<R> row) {
    const auto flat = row.flat;
    const auto nowhere = arena_.take<std::uint32_t>(n_);
    std::fill(nowhere.begin(), nowhere.end(), 0u);
    const std::vector<const std::uint32_t*> none(flat.size(), nowhere.data());
    row.flat = none;
    resolving::resolve_row<R>(weights_, row);
    for (std::size_t p = 0; p < flat.size(); ++p)
      for (std::size_t x = 0; x < n_; ++x)
        if (flat[p][x] != 0) row.out[p][x] = row.in[p][x];
  }

  // The samples of one plane in R; its origin is the top left corner of what is read.
  struct Source {
    const R* origin;
    std::ptrdiff_t sample_stride, row_stride;
    const R* at(int x, int y) const { return origin + y * row_stride + x; }
  };

  Source gather(int plane) {
    const RealPlane from = s_.planes[static_cast<std::size_t>(plane)];
    if (!s_.copies) return {in_.row<const R>(from.index, 0, read_.y0), in_.sample_stride(), in_.row_stride()};
    const auto width = static_cast<std::size_t>(read_.width());
    const std::span<R> copy = arena_.take<R>(static_cast<std::size_t>(read_.area() * in_.samples()));
    std::size_t at = 0;
    for (int k = 0; k < in_.samples(); ++k)
      for (int y = read_.y0; y < read_.y1; ++y, at += width) {
        const R* row = real_row<R>(in_, from, k, y, copy.subspan(at, width));
        if (row != copy.data() + at) std::copy_n(row, width, copy.data() + at);
      }
    return {copy.data(), static_cast<std::ptrdiff_t>(read_.area()), static_cast<std::ptrdiff_t>(width)};
  }

  // Marks the pixels all of whose samples in reach have the same bits. First pixel by pixel, then along rows,
  // then down columns; beyond the window the nearest column stands for what is not there.
  std::span<std::uint32_t> find_flat(const Source& source) {
    using Bits = kernels::BitsOf<R>;
    const auto m = static_cast<std::size_t>(m_), width = static_cast<std::size_t>(read_.width());
    const auto height = static_cast<std::size_t>(read_.height()), padded = n_ + 2 * m;
    const auto equal = arena_.take<std::uint32_t>(padded), across = arena_.take<std::uint32_t>(height * n_);
    const auto bits = arena_.take<Bits>(padded), centre = arena_.take<Bits>(height * n_);
    const auto skipped = static_cast<std::size_t>(read_.x0 - (rect_.x0 - m_));  // columns left of the window
    steps_.clear();
    for (std::ptrdiff_t d = -m_; d <= m_; ++d)
      if (d != 0) steps_.push_back(d);
    for (std::size_t y = 0; y < height; ++y) {
      find_equal_samples<R>(source.at(0, static_cast<int>(y)), in_.samples(), source.sample_stride, width,
                            equal.data() + skipped, bits.data() + skipped);
      std::fill_n(equal.begin(), skipped, equal[skipped]);
      std::fill_n(bits.begin(), skipped, bits[skipped]);
      const std::size_t end = skipped + width;
      std::fill(equal.begin() + static_cast<std::ptrdiff_t>(end), equal.end(), equal[end - 1]);
      std::fill(bits.begin() + static_cast<std::ptrdiff_t>(end), bits.end(), bits[end - 1]);
      find_equal_neighbours<Bits>(equal.data() + m, bits.data() + m, steps_, n_, across.data() + y * n_);
      std::copy_n(bits.data() + m, n_, centre.data() + y * n_);
    }

    const auto flat = arena_.take<std::uint32_t>(n_ * static_cast<std::size_t>(rect_.height()));
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      steps_.clear();
      for (int d = -m_; d <= m_; ++d)
        if (d != 0 && y + d >= read_.y0 && y + d < read_.y1)
          steps_.push_back(d * static_cast<std::ptrdiff_t>(n_));
      const std::size_t at = static_cast<std::size_t>(y - read_.y0) * n_;
      find_equal_neighbours<Bits>(across.data() + at, centre.data() + at, steps_, n_,
                                  flat.data() + static_cast<std::size_t>(y - rect_.y0) * n_);
    }
    return flat;
  }

  const State& s_;
  const ResolveWeights<R>& weights_;
  const int m_;
  const Tile& out_;
  const Rect rect_, read_;
  const Tile in_;
  Arena& arena_;
  const std::size_t n_;
  std::vector<int> wanted_;  // planes that somebody reads; of each:
  std::vector<Source> sources_;
  std::vector<std::span<std::uint32_t>> flat_;
  std::vector<std::ptrdiff_t> steps_;
};

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile &from = in[&Inputs::image], &to = out[&Outputs::image];
  if (std::holds_alternative<ResolveWeights<float>>(s.weights))
    Filler<float>(s, from, to, arena).fill();
  else
    Filler<double>(s, from, to, arena).fill();
}

}  // namespace

NodeType nodes::supersample_resolve() {
  return pixel_node("supersample.resolve", prepare, tile)
      .doc(
          "Weights the samples around each pixel's centre into one value, divided by the sum of the weights.")
      .cite(
          "Mitchell & Netravali 1988, Reconstruction filters in computer graphics, doi:10.1145/54852.378514")
      .covers(86, 92)
      .input("image", &Inputs::image,
             "Samples; planes of integers are left out. Without a pattern, pixel centres.")
      .param("filter", &Params::filter,
             "Shape of the weights; mitchell keeps edges sharp, with faint lobes beside them.")
      .knob_of_taste(
          {"box", "bartlett", "gaussian", "mitchell"},
          "Wider filters read more samples a pixel: less aliasing for more time; sharpness is taste.")
      .param("radius", &Params::radius,
             "Where the filter ends; null is its usual one: 0.5, 1, 1.5 and 2. Raising it blurs.",
             {.unit = "px", .range = between(0.5, 16)})
      .knob_of_taste({"0.5", "1", "1.5", "2", "3"},
                     "Reads (2 r)^2 pixels of samples: less aliasing, more blur, more time.")
      .output("image", &Outputs::image,
              "One value a pixel; where all samples in reach are equal, exactly that value.")
      .effect("reconstruction", reconstruction, "Samples are weighted by the filter, where they differ.",
              {"number", 2.5})  // tests/bench/effects_bench.cpp, one thread: 2.2 to 2.7
      .reads(reads)
      .blank_where(&Inputs::image);
}

}  // namespace frustum
