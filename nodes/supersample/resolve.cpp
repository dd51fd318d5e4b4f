#include "nodes/supersample/resolve.h"

#include "nodes/all_nodes.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

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
  std::vector<RealPlane> planes;  // those of the output, in its order
};

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
    ResolveWeights<R> weights(filter, pattern.samples, pattern.period, pattern.x, pattern.y);
    const int margin = weights.margin();
    return State{std::move(weights), from.window, margin, {}};
  });
  s.planes = std::move(planes);
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
        samples_(static_cast<std::size_t>(in.samples())),
        n_(static_cast<std::size_t>(rect_.width())),
        rows_(static_cast<std::size_t>(2 * m_ + 1)) {}

  void fill() {
    std::vector<std::size_t> wanted;
    for (std::size_t p = 0; p < s_.planes.size(); ++p)
      if (out_.has(static_cast<int>(p))) wanted.push_back(p);
    for (const std::size_t p : wanted) {
      gather(p);
      find_flat();
    }
    std::vector<const R*> in(wanted.size() * samples_ * rows_);
    std::vector<const std::uint32_t*> flat(wanted.size());
    std::vector<R*> to(wanted.size());
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      for (std::size_t i = 0; i < wanted.size(); ++i) {
        for (std::size_t k = 0; k < samples_; ++k)
          for (int dy = -m_; dy <= m_; ++dy)
            in[(i * samples_ + k) * rows_ + static_cast<std::size_t>(dy + m_)] = row(i, k, y + dy);
        flat[i] = flat_[i].data() + static_cast<std::size_t>(y - rect_.y0) * n_;
        to[i] = out_.row<R>(static_cast<int>(wanted[i]), 0, y);
      }
      resolving::resolve_row<R>(weights_, {.x0 = rect_.x0,
                                           .y = y,
                                           .n = n_,
                                           .left = s_.window.x0 - rect_.x0,
                                           .right = s_.window.x1 - rect_.x0,
                                           .in = in,
                                           .flat = flat,
                                           .out = to});
    }
  }

 private:
  std::size_t read_width() const { return static_cast<std::size_t>(read_.width()); }

  // The samples of a row from column rect.x0 on; null outside the window.
  const R* row(std::size_t plane, std::size_t sample, int y) const {
    if (y < read_.y0 || y >= read_.y1) return nullptr;
    return sample_rows_[plane][static_cast<std::size_t>(y - read_.y0) * samples_ + sample] +
           (rect_.x0 - read_.x0);
  }

  // Rows of one plane in R, [y][sample], from column read.x0 on.
  void gather(std::size_t plane) {
    const bool copies = s_.planes[plane].kind != plane_kind_of<R>;
    auto& rows = sample_rows_.emplace_back();
    for (int y = read_.y0; y < read_.y1; ++y)
      for (std::size_t k = 0; k < samples_; ++k)
        rows.push_back(real_row<R>(in_, s_.planes[plane], static_cast<int>(k), y,
                                   copies ? arena_.take<R>(read_width()) : std::span<R>()));
  }

  // Marks the pixels of the last plane that was gathered all of whose samples in reach have the same bits.
  // First pixel by pixel, then along rows, then down columns; beyond the window the nearest column stands for
  // what is not there.
  void find_flat() {
    using Bits = kernels::BitsOf<R>;
    const auto m = static_cast<std::size_t>(m_);
    const auto height = static_cast<std::size_t>(read_.height()), padded = n_ + 2 * m;
    const auto equal = arena_.take<std::uint32_t>(padded), across = arena_.take<std::uint32_t>(height * n_);
    const auto bits = arena_.take<Bits>(padded), centre = arena_.take<Bits>(height * n_);
    const auto skipped = static_cast<std::size_t>(read_.x0 - (rect_.x0 - m_));  // columns left of the window
    std::vector<std::ptrdiff_t> steps;
    for (std::ptrdiff_t d = -m_; d <= m_; ++d)
      if (d != 0) steps.push_back(d);
    for (std::size_t y = 0; y < height; ++y) {
      find_equal_samples<R>(std::span<const R* const>(sample_rows_.back()).subspan(y * samples_, samples_),
                            read_width(), equal.data() + skipped, bits.data() + skipped);
      for (std::size_t i = 0; i < skipped; ++i) equal[i] = equal[skipped], bits[i] = bits[skipped];
      const std::size_t last = skipped + read_width() - 1;
      for (std::size_t i = last + 1; i < padded; ++i) equal[i] = equal[last], bits[i] = bits[last];
      find_equal_neighbours<Bits>(equal.data() + m, bits.data() + m, steps, n_, across.data() + y * n_);
      std::copy_n(bits.data() + m, n_, centre.data() + y * n_);
    }

    auto& flat =
        flat_.emplace_back(arena_.take<std::uint32_t>(n_ * static_cast<std::size_t>(rect_.height())));
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      steps.clear();
      for (int d = -m_; d <= m_; ++d)
        if (d != 0 && y + d >= read_.y0 && y + d < read_.y1)
          steps.push_back(d * static_cast<std::ptrdiff_t>(n_));
      const std::size_t at = static_cast<std::size_t>(y - read_.y0) * n_;
      find_equal_neighbours<Bits>(across.data() + at, centre.data() + at, steps, n_,
                                  flat.data() + static_cast<std::size_t>(y - rect_.y0) * n_);
    }
  }

  const State& s_;
  const ResolveWeights<R>& weights_;
  const int m_;
  const Tile& out_;
  const Rect rect_, read_;
  const Tile in_;
  Arena& arena_;
  const std::size_t samples_, n_, rows_;
  std::vector<std::vector<const R*>> sample_rows_;  // of each wanted plane
  std::vector<std::span<std::uint32_t>> flat_;
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
      .param("radius", &Params::radius,
             "Where the filter ends; null is its usual one: 0.5, 1, 1.5 and 2. Raising it blurs.",
             {.unit = "px", .range = between(0.5, 16)})
      .output("image", &Outputs::image,
              "One value a pixel; where all samples in reach are equal, exactly that value.")
      .reads(reads);
}

}  // namespace frustum
