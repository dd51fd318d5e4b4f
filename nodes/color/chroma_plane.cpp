#include "nodes/color/chroma_plane.h"

#include "nodes/color.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_pixels.h"

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> image;
};
struct Params {};
struct Outputs {
  Tiled<Image> image, defined;
};

Prepared<ColorPixels, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  ColorPixels pixels = ColorPixels::of(in.image, {"R", "G", "B"}, ctx.precision);
  Frame to = color_frame(in.image.frame(), {"R", "G", "B"}, ctx.precision);
  to.color_space = color_space_of(in.image.frame());
  Frame flag = to;
  flag.planes = {{"defined", real_kind(ctx.precision)}};
  flag.color_space.clear(), flag.alpha = Alpha::none;
  return {std::move(pixels), {std::move(to), std::move(flag)}};
}

template <class R>
void fill(const ColorPixels& pixels, const Tile& in, const TilesOf<Outputs>& out, Arena& arena) {
  fill_colors<R, 3, 3>(pixels, in, out[&Outputs::image], arena,
                       [](const std::array<R, 3>& v) { return color::on_chroma_plane<R>(v).part; });
  fill_flags<R>(pixels, in, out[&Outputs::defined], arena,
                [](const std::array<R, 3>& v) { return color::on_chroma_plane<R>(v).defined; });
}

void tile(const ColorPixels& pixels, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs,
          Arena& arena) {
  if (pixels.precision == Precision::single)
    fill<float>(pixels, inputs[&Inputs::image], outputs, arena);
  else
    fill<double>(pixels, inputs[&Inputs::image], outputs, arena);
}

}  // namespace

NodeType nodes::color_chroma_plane() {
  return pixel_node("color.chroma_plane", prepare, tile)
      .doc(
          "Moves colours along their lines from black to the plane R + G + B = 1: what is left is "
          "chromaticity.")
      .cite("Maxwell 1860, On the theory of compound colours, doi:10.1098/rstl.1860.0005; errata E55")
      .covers(100)
      .input("image", &Inputs::image, "Planes R, G and B of any space; linear light has a meaning.")
      .output("image", &Outputs::image,
              "Parts of red, green and blue with the sum 1, times A where premultiplied; (1, 1, 1) / 3 for "
              "black.")
      .output("defined", &Outputs::defined, "1 where R + G + B is not 0; else 0, as for black and NaN.");
}

}  // namespace frustum
