#include "nodes/color/cmy.h"

#include "nodes/color.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_pixels.h"

namespace frustum {
namespace {

enum class Way { to_inks, to_rgb };
constexpr auto choices(Way) {
  return std::array{std::pair{Way::to_inks, "to_inks"}, std::pair{Way::to_rgb, "to_rgb"}};
}

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  Way way = Way::to_inks;
  bool black = false;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  ColorPixels pixels;
  Way way;
  bool black;
};

// Inks are not premultiplied: what covers nothing is no white paper.
Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  if (p.way == Way::to_inks) {
    State s{ColorPixels::of(in.image, {"R", "G", "B"}, ctx.precision), p.way, p.black};
    s.pixels.multiplies = false;
    Frame to = p.black ? color_frame(from, {"C", "M", "Y", "K"}, ctx.precision)
                       : color_frame(from, {"C", "M", "Y"}, ctx.precision);
    to.color_space = color_space_of(from);
    if (to.alpha == Alpha::premultiplied) to.alpha = Alpha::straight;
    return {std::move(s), {std::move(to)}};
  }
  State s{ColorPixels::of(in.image, {"C", "M", "Y"}, ctx.precision), p.way, p.black};
  if (p.black) s.pixels.color[3] = read_real(in.image, "K", ctx.precision);
  s.pixels.multiplies = s.pixels.alpha && from.alpha == Alpha::straight;
  Frame to = color_frame(from, {"R", "G", "B"}, ctx.precision);
  to.color_space = color_space_of(from);
  if (s.pixels.multiplies) to.alpha = Alpha::premultiplied;
  return {std::move(s), {std::move(to)}};
}

template <class R>
void fill(const State& s, const Tile& in, const Tile& out, Arena& arena) {
  if (!s.black)
    fill_colors<R, 3, 3>(s.pixels, in, out, arena, color::complement<R>);
  else if (s.way == Way::to_inks)
    fill_colors<R, 3, 4>(s.pixels, in, out, arena, color::cmyk_of_rgb<R>);
  else
    fill_colors<R, 4, 3>(s.pixels, in, out, arena, color::rgb_of_cmyk<R>);
}

void tile(const State& s, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs, Arena& arena) {
  const Tile out = outputs[&Outputs::image], in = inputs[&Inputs::image].part(out.rect());
  if (s.pixels.precision == Precision::single)
    fill<float>(s, in, out, arena);
  else
    fill<double>(s, in, out, arena);
}

}  // namespace

NodeType nodes::color_cmy() {
  return pixel_node("color.cmy", prepare, tile)
      .doc(
          "Cyan, magenta and yellow: what inks take from white to leave a colour, 1 - R, 1 - G, 1 - B; or "
          "the way back.")
      .cite("Errata E57; hard case COL-12; an ideal block of ink, without dot gain")
      .covers(104)
      .input("image", &Inputs::image,
             "Planes R, G and B, divided by A where they are premultiplied; or the inks.")
      .param("way", &Params::way, "From R, G, B to inks or back.")
      .param("black", &Params::black, "Whether a fourth ink K takes what the three have in common.")
      .output("image", &Outputs::image,
              "C, M, Y (and K), not premultiplied; or R, G and B of the space they were made of.");
}

}  // namespace frustum
