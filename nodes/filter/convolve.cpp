#include "nodes/filter/convolve.h"

#include "nodes/filter.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

using namespace convolution;
using kernels::FilterKind;

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  FilterKind kernel = FilterKind::gaussian;
  double radius = 3;
  Border border = Border::clamp;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  std::variant<std::vector<float>, std::vector<double>> taps;
  int margin = 0;
  Border border;
  Rect window;
  std::vector<RealPlane> planes;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  State s{.taps = {}, .margin = 0, .border = p.border, .window = in.image.frame().window, .planes = {}};
  ctx.real([&]<class R>() {
    auto taps = symmetric_taps<R>({.kind = p.kernel, .radius = p.radius});
    s.margin = static_cast<int>(taps.size() / 2);
    s.taps = std::move(taps);
  });
  Frame to = in.image.frame();
  to.planes.clear();
  for (const Plane& plane : in.image.frame().planes) {
    if (plane.kind == PlaneKind::u32) continue;
    s.planes.push_back(read_real(in.image, plane.name, ctx.precision));
    to.planes.push_back({plane.name, real_kind(ctx.precision)});
  }
  return {std::move(s), {std::move(to)}};
}

// A border that repeats reads the far side of the picture.
Rect reads(const State& s, std::string_view, Rect rect) {
  Rect r = rect.grown(s.margin);
  if (s.border != Border::repeat) return r;
  if (r.x0 < s.window.x0 || r.x1 > s.window.x1) r.x0 = s.window.x0, r.x1 = s.window.x1;
  if (r.y0 < s.window.y0 || r.y1 > s.window.y1) r.y0 = s.window.y0, r.y1 = s.window.y1;
  return r;
}

// One plane of one sample: rows first, into memory of the tile, then columns.
template <class R>
class Plane2D {
 public:
  Plane2D(const State& s, const Tile& in, const Tile& out, Arena& arena)
      : s_(s),
        taps_(std::get<std::vector<R>>(s.taps)),
        in_(in),
        out_(out),
        rect_(out.rect()),
        read_(intersection(reads(s, "image", rect_), s.window)),
        n_(static_cast<std::size_t>(rect_.width())),
        width_(n_ + 2 * static_cast<std::size_t>(s.margin)),
        padded_(arena.take<R>(width_)),
        scratch_(arena.take<R>(static_cast<std::size_t>(read_.width()))),
        zero_(arena.take<R>(n_)),
        across_(arena.take<R>(static_cast<std::size_t>(rect_.height() + 2 * s.margin) * n_)) {
    std::fill(zero_.begin(), zero_.end(), R(0));
  }

  void fill(std::size_t plane, int sample) {
    const int m = s_.margin;
    std::vector<const R*> rows(taps_.size()), lines;
    for (std::size_t k = 0; k < taps_.size(); ++k) rows[k] = padded_.data() + k;
    for (int y = rect_.y0 - m; y < rect_.y1 + m; ++y) {
      const int from = border_index(y, s_.window.y0, s_.window.y1, s_.border);
      if (from == no_index) {
        lines.push_back(zero_.data());
        continue;
      }
      pad(plane, sample, from);
      R* to = across_.data() + lines.size() * n_;
      weigh_rows<R>(rows, taps_, n_, to);
      lines.push_back(to);
    }
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      const auto first = static_cast<std::size_t>(y - rect_.y0);
      weigh_rows<R>(std::span<const R* const>(lines).subspan(first, taps_.size()), taps_, n_,
                    out_.row<R>(static_cast<int>(plane), sample, y));
    }
  }

 private:
  // Row y from column rect.x0 - m to rect.x1 + m, with the border around the window.
  void pad(std::size_t plane, int sample, int y) {
    const R* row = real_row<R>(in_.part(read_), s_.planes[plane], sample, y, scratch_);
    for (std::size_t i = 0; i < width_; ++i) {
      const int x = rect_.x0 - s_.margin + static_cast<int>(i);
      const int from = border_index(x, s_.window.x0, s_.window.x1, s_.border);
      padded_[i] = from == no_index ? R(0) : row[from - read_.x0];
    }
  }

  const State& s_;
  const std::vector<R>& taps_;
  const Tile &in_, &out_;
  const Rect rect_, read_;
  const std::size_t n_, width_;
  std::span<R> padded_, scratch_, zero_, across_;
};

template <class R>
void fill(const State& s, const Tile& in, const Tile& out, Arena& arena) {
  Plane2D<R> filter(s, in, out, arena);
  for (std::size_t p = 0; p < s.planes.size(); ++p)
    for (int k = 0; k < out.samples(); ++k)
      if (out.has(static_cast<int>(p))) filter.fill(p, k);
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile &from = in[&Inputs::image], &to = out[&Outputs::image];
  if (std::holds_alternative<std::vector<float>>(s.taps))
    fill<float>(s, from, to, arena);
  else
    fill<double>(s, from, to, arena);
}

}  // namespace

NodeType nodes::filter_convolve() {
  return pixel_node("filter.convolve", prepare, tile)
      .doc(
          "Convolves an image with a smooth kernel of weight 1, in two passes: along rows, then down "
          "columns.")
      .covers(89, 90, 91)
      .input("image", &Inputs::image,
             "Any real planes, each sample by itself; planes of integers are left out.")
      .param("kernel", &Params::kernel, "Shape of the kernel; all are even, so nothing is shifted.")
      .param("radius", &Params::radius, "Where the kernel ends; raising it blurs more and takes longer.",
             {.unit = "px", .range = between(0, 256)})
      .param("border", &Params::border,
             "What lies beyond the picture: its edge, nothing, its mirror image or its far side.")
      .output("image", &Outputs::image,
              "The smoothed image; a constant stays what it is, bit for bit, where it is not zero-padded.")
      .reads(reads);
}

}  // namespace frustum
