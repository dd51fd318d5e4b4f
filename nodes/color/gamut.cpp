#include "nodes/color/gamut.h"

#include "nodes/color.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color_pixels.h"

namespace frustum {

// Found by their arguments.
namespace color {
constexpr auto choices(Gamut) {
  return std::array{std::pair{Gamut::light, "light"}, std::pair{Gamut::display, "display"}};
}
constexpr auto choices(Mapping) {
  return std::array{std::pair{Mapping::clip, "clip"}, std::pair{Mapping::desaturate, "desaturate"}};
}
}  // namespace color

namespace {

struct Inputs {
  Tiled<Image> image;
};
struct Params {
  std::string of = "srgb";
  color::Gamut bound = color::Gamut::light;
  color::Mapping method = color::Mapping::desaturate;
};
struct Outputs {
  Tiled<Image> image, inside;
};

struct State {
  ColorPixels pixels;
  color::Gamut bound;
  color::Mapping method;
  std::array<double, 3> weights;
};

void check(const Params& p) {
  try {
    if (luminance_weights(linear_space_of(p.of)) == std::array<double, 3>{0, 1, 0})
      throw NodeError("no_primaries", fmt::format("{} is no space of three lamps, so it has no gamut", p.of));
  } catch (const NodeError& e) {
    throw NodeError(e.code, e.what(), at_param("of"));
  }
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const std::string space = linear_space_of(p.of);
  State s{ColorPixels::of(in.image, {"R", "G", "B"}, ctx.precision), p.bound, p.method,
          luminance_weights(space)};
  s.pixels.convert(in.image.frame(), space);
  Frame to = color_frame(in.image.frame(), {"R", "G", "B"}, ctx.precision);
  to.color_space = space;
  Frame flag = to;
  flag.planes = {{"inside", real_kind(ctx.precision)}};
  flag.color_space.clear(), flag.alpha = Alpha::none;
  return {std::move(s), {std::move(to), std::move(flag)}};
}

template <class R>
void fill(const State& s, const Tile& in, const TilesOf<Outputs>& out, Arena& arena) {
  const std::array<R, 3> w{R(s.weights[0]), R(s.weights[1]), R(s.weights[2])};
  fill_colors<R, 3, 3>(s.pixels, in, out[&Outputs::image], arena,
                       [&](const std::array<R, 3>& v) { return color::mapped<R>(v, s.bound, s.method, w); });
  fill_flags<R>(s.pixels, in, out[&Outputs::inside], arena,
                [&](const std::array<R, 3>& v) { return color::inside<R>(v, s.bound); });
}

void tile(const State& s, const TilesOf<Inputs>& inputs, const TilesOf<Outputs>& outputs, Arena& arena) {
  if (s.pixels.precision == Precision::single)
    fill<float>(s, inputs[&Inputs::image], outputs, arena);
  else
    fill<double>(s, inputs[&Inputs::image], outputs, arena);
}

}  // namespace

NodeType nodes::color_gamut() {
  return pixel_node("color.gamut", prepare, tile)
      .doc(
          "Says which colours three primaries can mix, and puts one that they can in the place of the "
          "others.")
      .cite(
          "Errata E56, E57; hard case COL-13; SMPTE RP 177-1993; primaries of ITU-R BT.709-6, BT.2020-2, "
          "SMPTE EG 432-1")
      .covers(103)
      .check(check)
      .input("image", &Inputs::image,
             "Planes R, G and B of an embedded space, decoded to linear light first.")
      .param("of", &Params::of, "Space whose primaries count: srgb, display_p3, rec2020, acescg ...")
      .param("bound", &Params::bound, "light: no part below 0, however bright; display: none above 1 either.")
      .param("method", &Params::method,
             "clip: each part is cut, which changes the hue; desaturate: towards the grey of its luminance.")
      .output("image", &Outputs::image, "Linear light of those primaries; colours inside keep every bit.")
      .output("inside", &Outputs::inside,
              "1 where the colour is a mixture of the primaries, else 0, as for NaN.");
}

}  // namespace frustum
