#include "nodes/color/luminance.h"

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
  Tiled<Image> luminance, grey;
};

struct State {
  ColorPixels pixels;
  std::array<double, 3> weights;
};

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Frame& from = in.image.frame();
  State s{ColorPixels::of(in.image, {"R", "G", "B"}, ctx.precision), {}};
  const std::string linear = linear_space_of(color_space_of(from));
  s.pixels.convert(from, linear);
  s.weights = luminance_weights(linear);
  Frame grey = color_frame(from, {"R", "G", "B"}, ctx.precision);
  grey.color_space = std::string(linear_rec709);
  Frame number = color_frame(from, {"Y"}, ctx.precision);
  number.color_space.clear();
  return {std::move(s), {std::move(number), std::move(grey)}};
}

template <class R>
void fill(const State& s, const Tile& in, const TilesOf<Outputs>& out, Arena& arena) {
  const std::array<R, 3> w{R(s.weights[0]), R(s.weights[1]), R(s.weights[2])};
  fill_colors<R, 3, 1>(s.pixels, in, out[&Outputs::luminance], arena, [&](const std::array<R, 3>& v) {
    return std::array<R, 1>{color::luminance<R>(v, w)};
  });
  fill_colors<R, 3, 3>(s.pixels, in, out[&Outputs::grey], arena, [&](const std::array<R, 3>& v) {
    const R y = color::luminance<R>(v, w);
    return std::array<R, 3>{y, y, y};
  });
}

void tile(const State& s, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs, Arena& arena) {
  if (s.pixels.precision == Precision::single)
    fill<float>(s, inputs[&Inputs::image], outputs, arena);
  else
    fill<double>(s, inputs[&Inputs::image], outputs, arena);
}

}  // namespace

NodeType nodes::color_luminance() {
  return pixel_node("color.luminance", prepare, tile)
      .doc(
          "Luminance Y of colours relative to white, and the grey that is as bright; of spectra it knows "
          "nothing.")
      .cite("CIE 15:2018; SMPTE RP 177-1993 for the weights of primaries; errata E53")
      .input("image", &Inputs::image,
             "Planes R, G and B of an embedded space; encoded ones are decoded first.")
      .output("luminance", &Outputs::luminance, "Plane Y, linear, 1 for white, times A where premultiplied.")
      .output("grey", &Outputs::grey, "R = G = B = Y in lin_rec709, with the alpha of the image.");
}

}  // namespace frustum
