#include "nodes/image/magnify.h"

#include "nodes/image.h"
#include "runtime/buffers/image.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  int factor = 8;
  std::optional<Color> grid;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  int factor;
  std::optional<glm::dvec3> grid;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context&) {
  Frame frame = in.image.frame();
  if (frame.samples() != 1)
    throw NodeError("sampled_image", fmt::format("{} values a pixel: resolve them first", frame.samples()),
                    at_input("image"));
  constexpr int limit = 65536;
  const Rect& w = frame.window;
  for (const int end : {w.x0, w.y0, w.x1, w.y1})
    if (std::abs(std::int64_t{end} * p.factor) > limit)
      throw NodeError("too_large",
                      fmt::format("{} x {} pixels, {} times as large, reach beyond {} px", w.width(),
                                  w.height(), p.factor, limit),
                      at_param("factor"));
  for (const Plane& plane : frame.planes) in.image.read(plane.name);
  frame.window = {w.x0 * p.factor, w.y0 * p.factor, w.x1 * p.factor, w.y1 * p.factor};
  State s{p.factor, p.grid ? std::optional(p.grid->rgb) : std::nullopt};
  return {s, {std::move(frame)}};
}

Rect reads(const State& s, std::string_view, Rect r) {
  const auto div = [&](int v) { return magnify::floor_div(v, s.factor); };
  return {div(r.x0), div(r.y0), div(r.x1 - 1) + 1, div(r.y1 - 1) + 1};
}

// The value of the lines in a plane of colour; nothing in others.
std::optional<double> grid_value(const State& s, const std::string& plane) {
  if (!s.grid) return std::nullopt;
  if (plane == "A") return 1;
  for (glm::length_t c = 0; c < 3; ++c)
    if (plane == std::string(1, "RGB"[c])) return (*s.grid)[c];
  return std::nullopt;
}

template <class T>
void fill(const State& s, int plane, const Tile& from, const Tile& to) {
  const Rect& r = to.rect();
  const auto line = grid_value(s, to.frame().planes[static_cast<std::size_t>(plane)].name);
  for (int y = r.y0; y < r.y1; ++y) {
    T* out = to.row<T>(plane, 0, y);
    magnify::repeat_row(from.row<const T>(plane, 0, magnify::floor_div(y, s.factor)), from.rect().x0, r.x0,
                        r.x1, s.factor, out);
    if constexpr (std::is_floating_point_v<T>)
      for (int x = r.x0; line && x < r.x1; ++x)
        if (magnify::on_grid(x, y, s.factor)) out[x - r.x0] = static_cast<T>(*line);
  }
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena&) {
  const Tile &from = in[&Inputs::image], &to = out[&Outputs::image];
  for (int plane = 0; plane < static_cast<int>(to.frame().planes.size()); ++plane) {
    if (!to.has(plane)) continue;
    switch (to.frame().planes[static_cast<std::size_t>(plane)].kind) {
      case PlaneKind::f32: fill<float>(s, plane, from, to); break;
      case PlaneKind::f64: fill<double>(s, plane, from, to); break;
      case PlaneKind::u32: fill<std::uint32_t>(s, plane, from, to); break;
    }
  }
}

}  // namespace

NodeType nodes::image_magnify() {
  return pixel_node("image.magnify", prepare, tile)
      .reads(reads)
      .doc("Shows every pixel as a square of pixels, without smoothing, so that one can count them.")
      .input("image", &Inputs::image, "One value a pixel; every plane is kept.")
      .param("factor", &Params::factor, "Side of the squares; raising it makes them larger.",
             {.unit = "px", .range = between(1, 256)})
      .param("grid", &Params::grid, "Colour of lines between the squares, linear Rec.709; null draws none.",
             {.range = at_least(0)})
      .output("image", &Outputs::image, "The squares; the window is as many times as large.");
}

}  // namespace frustum
