#include "nodes/color/xy.h"

#include "nodes/color.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_pixels.h"

#include "runtime/io/primaries.h"

namespace frustum {
namespace {

enum class Way { to_xyy, to_xyz };
constexpr auto choices(Way) {
  return std::array{std::pair{Way::to_xyy, "to_xyy"}, std::pair{Way::to_xyz, "to_xyz"}};
}

constexpr const char* xyz_space = "xyz_d65";

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  Way way = Way::to_xyy;
};
struct Outputs {
  Tiled<Image> image, defined;
};

struct State {
  ColorPixels pixels;
  Way way;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.image.frame();
  const bool there = p.way == Way::to_xyy;
  State s{there ? ColorPixels::of(in.image, {"R", "G", "B"}, ctx.precision)
                : ColorPixels::of(in.image, {"x", "y", "Y"}, ctx.precision),
          p.way};
  Frame to = there ? color_frame(from, {"x", "y", "Y"}, ctx.precision)
                   : color_frame(from, {"R", "G", "B"}, ctx.precision);
  if (there) {
    s.pixels.convert(from, xyz_space);
    s.pixels.multiplies = false;
    if (to.alpha == Alpha::premultiplied) to.alpha = Alpha::straight;
  } else {
    s.pixels.multiplies = s.pixels.alpha && from.alpha == Alpha::straight;
    if (s.pixels.multiplies) to.alpha = Alpha::premultiplied;
  }
  to.color_space = xyz_space;
  Frame flag = to;
  flag.planes = {{"defined", real_kind(ctx.precision)}};
  flag.color_space.clear(), flag.alpha = Alpha::none;
  return {std::move(s), {std::move(to), std::move(flag)}};
}

template <class R>
void fill(const State& s, const Tile& in, const TilesOf<Outputs>& out, Arena& arena) {
  const std::array<R, 2> white{R(d65_x), R(d65_y)};
  const Tile &image = out[&Outputs::image], &defined = out[&Outputs::defined];
  if (s.way == Way::to_xyy) {
    fill_colors<R, 3, 3>(s.pixels, in, image, arena,
                         [&](const std::array<R, 3>& v) { return color::xyy_of_xyz<R>(v, white); });
    fill_flags<R>(s.pixels, in, defined, arena, color::has_xy<R>);
  } else {
    fill_colors<R, 3, 3>(s.pixels, in, image, arena, color::xyz_of_xyy<R>);
    fill_flags<R>(s.pixels, in, defined, arena,
                  [](const std::array<R, 3>& v) { return v[1] != 0 || v[2] == 0; });
  }
}

void tile(const State& s, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs, Arena& arena) {
  if (s.pixels.precision == Precision::single)
    fill<float>(s, inputs[&Inputs::image], outputs, arena);
  else
    fill<double>(s, inputs[&Inputs::image], outputs, arena);
}

}  // namespace

NodeType nodes::color_xy() {
  return pixel_node("color.xy", prepare, tile)
      .doc("Chromaticity x, y and luminance Y of the CIE 1931 observer, white D65; or the way back to XYZ.")
      .cite("CIE 15:2018, 7.3; ITU-R BT.709-6 for the white; hard case COL-11")
      .covers(102)
      .input("image", &Inputs::image,
             "R, G and B of an embedded space, decoded and made XYZ first; or x, y and Y.")
      .param("way", &Params::way, "From colours to x, y, Y or from these to XYZ.")
      .output(
          "image", &Outputs::image,
          "x, y, Y, not premultiplied (black: those of D65, and 0); or X, Y, Z in R, G, B of space xyz_d65.")
      .output("defined", &Outputs::defined,
              "1 where X + Y + Z is not 0, else 0; on the way back 1 where y can be divided by.");
}

}  // namespace frustum
