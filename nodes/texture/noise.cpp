#include "nodes/texture/noise.h"

#include "nodes/texture.h"
#include "runtime/buffers/places.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

enum class Form : std::uint8_t { smooth, turbulent };
constexpr auto choices(Form) {
  return std::array{std::pair{Form::smooth, "smooth"}, std::pair{Form::turbulent, "turbulent"}};
}

struct Inputs {
  Tiled<Image> points;
};
struct Params {
  Domain3 domain = Domain3::world;
  double scale = 4;
  int octaves = 6;
  double lacunarity = 2, gain = 0.5;
  Form form = Form::smooth;
  double contrast = 2;
  bool bounded = true;
  Color low{glm::dvec3{0}}, high{glm::dvec3{1}};
};
struct Outputs {
  Tiled<Image> image;
};

using State = SpaceTexture<Params>;

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  return prepare_space_texture<Outputs>(in, p, ctx);
}

template <class R>
void fill(const State& s, const Tile& points, const Tile& out, Arena& arena) {
  const texture::NoiseLook look{
      {s.look.octaves, s.look.lacunarity, s.look.gain, s.look.form == Form::turbulent},
      s.look.scale,
      s.look.contrast,
      s.look.bounded};
  paint_mix<R>(s.places, points, out, arena, s.look.low.rgb, s.look.high.rgb,
               [&](const kernels::PlaceRows<R>& rows, std::size_t n, R* mix) {
                 texture::noise_row(look, rows, n, mix);
               });
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  const Tile& to = out[&Outputs::image];
  const Tile points = in[&Inputs::points].part(to.rect());
  if (s.precision == Precision::single)
    fill<float>(s, points, to, arena);
  else
    fill<double>(s, points, to, arena);
}

}  // namespace

NodeType nodes::texture_noise() {
  return pixel_node("texture.noise", prepare, tile)
      .doc("Colours points by gradient noise: octaves of it, down to those that a pixel can still resolve.")
      .cite(
          "Perlin 2002, Improving Noise, doi:10.1145/566654.566636; errata E19: textures need not be images")
      .covers(30)
      .input("points", &Inputs::points,
             "Visible points with uv or world positions; transparent black where none is.")
      .param("domain", &Params::domain,
             "Noise over the surface's uv, or in the world, which the surface cuts.")
      .param("scale", &Params::scale, "Cells of the first octave a unit; raising it makes them smaller.",
             {.range = above(0)})
      .param("octaves", &Params::octaves, "Octaves that are added; raising it adds finer detail.",
             {.range = between(1, 24)})
      .knob({"1", "2", "4", "6", "8", "12"},
            "Each octave left out leaves out detail of gain times the height.")
      .param("lacunarity", &Params::lacunarity,
             "From an octave's frequency to the next one's; raising it skips detail.",
             {.range = between(1, 8)})
      .param("gain", &Params::gain, "From an octave's height to the next one's; raising it roughens.",
             {.range = between(0.01, 1)})
      .param("form", &Params::form, "smooth adds noise, turbulent its absolute value, which creases.")
      .param("contrast", &Params::contrast,
             "Scales the sum; raising it uses more of the colours, and clips at both ends.",
             {.range = above(0)})
      .param("bounded", &Params::bounded,
             "Whether octaves finer than a pixel fade to their mean; without it they alias.")
      .knob({"false", "true"}, "What a pixel cannot resolve is noise from pixel to pixel, and flickers.")
      .param("low", &Params::low, "Colour where noise is lowest, linear Rec.709.", {.range = at_least(0)})
      .param("high", &Params::high, "Colour where noise is highest, linear Rec.709.", {.range = at_least(0)})
      .output("image", &Outputs::image,
              "Colour at every sample, linear Rec.709, premultiplied; albedo for shading.")
      .seen(seen_without_ids<State>)
      .blank_where(&Inputs::points);
}

}  // namespace frustum
