#include "nodes/color/rgb_hsv.h"

#include "nodes/color.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_pixels.h"

namespace frustum {
namespace {

enum class Way { to_hsv, to_rgb };
constexpr auto choices(Way) {
  return std::array{std::pair{Way::to_hsv, "to_hsv"}, std::pair{Way::to_rgb, "to_rgb"}};
}

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  Way way = Way::to_hsv;
};
struct Outputs {
  Tiled<Image> image;
};

struct State {
  ColorPixels pixels;
  Way way;
};

// H, S and V are not premultiplied: a share of a hue is another hue.
Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  if (p.way == Way::to_hsv) {
    State s{ColorPixels::of(in.image, {"R", "G", "B"}, ctx.precision), p.way};
    s.pixels.multiplies = false;
    Frame to = color_frame(from, {"H", "S", "V"}, ctx.precision);
    to.color_space = color_space_of(from);
    if (to.alpha == Alpha::premultiplied) to.alpha = Alpha::straight;
    return {std::move(s), {std::move(to)}};
  }
  State s{ColorPixels::of(in.image, {"H", "S", "V"}, ctx.precision), p.way};
  s.pixels.multiplies = s.pixels.alpha && from.alpha == Alpha::straight;
  Frame to = color_frame(from, {"R", "G", "B"}, ctx.precision);
  to.color_space = color_space_of(from);
  if (s.pixels.multiplies) to.alpha = Alpha::premultiplied;
  return {std::move(s), {std::move(to)}};
}

template <class R>
void fill(const State& s, const Tile& in, const Tile& out, Arena& arena) {
  if (s.way == Way::to_hsv)
    fill_colors<R, 3, 3>(s.pixels, in, out, arena, color::hsv_of_rgb<R>);
  else
    fill_colors<R, 3, 3>(s.pixels, in, out, arena, color::rgb_of_hsv<R>);
}

void tile(const State& s, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs, Arena& arena) {
  const Tile out = outputs[&Outputs::image], in = inputs[&Inputs::image].part(out.rect());
  if (s.pixels.precision == Precision::single)
    fill<float>(s, in, out, arena);
  else
    fill<double>(s, in, out, arena);
}

}  // namespace

NodeType nodes::color_rgb_hsv() {
  return pixel_node("color.rgb_hsv", prepare, tile)
      .doc(
          "Hue, saturation and value of the numbers of a picture as they are, encoded or linear; or the way "
          "back.")
      .cite("Smith 1978, Color gamut transform pairs, doi:10.1145/965139.807361")
      .covers(99)
      .input("image", &Inputs::image,
             "Planes R, G and B, divided by A where they are premultiplied; or H, S and V.")
      .param("way", &Params::way, "From R, G, B to H, S, V or back.")
      .output("image", &Outputs::image,
              "H in degrees (0 for grey), S and V, not premultiplied; or R, G and B of the space they were "
              "made of.");
}

}  // namespace frustum
