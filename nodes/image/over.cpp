#include "nodes/image/over.h"

#include "nodes/image.h"
#include "runtime/buffers/rgba_planes.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> image;
  std::optional<Tiled<Image>> under;
};
struct Params {
  Color top{glm::dvec3{1}};
  std::optional<Color> bottom;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  Precision precision;
  std::array<RealPlane, 4> over{}, under{};
  glm::dvec3 top, bottom;
  Rect window;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  State s{ctx.precision, read_rgba(in.image, ctx.precision), {},
          p.top.rgb,     p.bottom.value_or(p.top).rgb,       from.window};
  if (in.under) {
    const Frame& below = in.under->frame();
    const auto period = [](const Frame& f) { return f.pattern ? f.pattern->period : 1; };
    if (below.window != from.window || below.samples() != from.samples() || period(below) != period(from))
      throw NodeError("frames_differ",
                      fmt::format("the pictures are {} x {} with {} and {} x {} with {} "
                                  "samples a pixel",
                                  from.window.width(), from.window.height(), from.samples(),
                                  below.window.width(), below.window.height(), below.samples()));
    s.under = read_rgba(*in.under, ctx.precision);
  }
  Frame to = from;
  to.alpha = Alpha::premultiplied;
  to.planes.clear();
  for (const char* name : rgba_names) to.planes.push_back({name, real_kind(ctx.precision)});
  return {std::move(s), {std::move(to)}};
}

template <class R>
void fill(const State& s, const Tile& over, const Tile& under, const Tile& out, Arena& arena) {
  const auto n = static_cast<std::size_t>(out.rect().width());
  const auto scratch = arena.take<R>(3 * n);
  const auto ones = arena.take<R>(n);
  std::fill(ones.begin(), ones.end(), R(1));
  for (int k = 0; k < out.samples(); ++k)
    for (int y = out.rect().y0; y < out.rect().y1; ++y) {
      const double down = (y + 0.5 - s.window.y0) / s.window.height();
      const R* alpha = real_row<R>(over, s.over[3], k, y, scratch.subspan(0, n));
      for (std::size_t c = 0; c < 4; ++c) {
        R* to = out_row<R>(out, static_cast<int>(c), k, y);
        if (to == nullptr) continue;
        const auto axis = static_cast<glm::length_t>(c);
        const double paper = c == 3 ? 1 : s.top[axis] + (s.bottom[axis] - s.top[axis]) * down;
        const R* above = s.over[c] ? real_row<R>(over, s.over[c], k, y, scratch.subspan(n, n)) : ones.data();
        const R* below =
            under.empty() ? nullptr : real_row<R>(under, s.under[c], k, y, scratch.subspan(2 * n, n));
        image::over_row<R>(above, alpha, below, static_cast<R>(paper), n, to);
      }
    }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& image = out[&Outputs::image];
  const Tile &over = in[&Inputs::image], &under = in[&Inputs::under];
  const Tile below = under.empty() ? under : under.part(image.rect());
  if (s.precision == Precision::single)
    fill<float>(s, over.part(image.rect()), below, image, arena);
  else
    fill<double>(s, over.part(image.rect()), below, image, arena);
}

}  // namespace

NodeType nodes::image_over() {
  return pixel_node("image.over", prepare, tile)
      .doc("Puts a picture over another one, or over paper whose colour may change from top to bottom.")
      .cite("Porter & Duff 1984, Compositing digital images, doi:10.1145/964965.808606")
      .input("image", &Inputs::image,
             "What lies on top: R, G, B, premultiplied by A; without A it is opaque.")
      .input("under", &Inputs::under, "What shows through, of the same size and samples; else the paper.")
      .param("top", &Params::top, "Colour of the paper at the top of the picture.", {.range = at_least(0)})
      .param("bottom", &Params::bottom, "Its colour at the bottom, mixed in linear light; null is the top's.",
             {.range = at_least(0)})
      .output("image", &Outputs::image, "Both as one, premultiplied; over paper it is opaque.");
}

}  // namespace frustum
