#include "nodes/texture/marble.h"

#include "nodes/texture.h"
#include "runtime/buffers/places.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Tiled<Image> points;
};
struct Params {
  Domain3 domain = Domain3::world;
  glm::dvec3 axis{1, 0.3, 0.2};
  double scale = 2, bend = 2;
  int octaves = 6;
  bool bounded = true;
  Color low{glm::dvec3{0.09, 0.07, 0.08}}, high{glm::dvec3{0.82, 0.8, 0.74}};
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
  const texture::Marble marble{{s.look.axis.x, s.look.axis.y, s.look.axis.z},
                               s.look.scale,
                               s.look.bend,
                               {.count = s.look.octaves, .lacunarity = 2, .gain = 0.5, .turbulent = true}};
  paint_mix<R>(s.places, points, out, arena, s.look.low.rgb, s.look.high.rgb,
               [&](const kernels::PlaceRows<R>& rows, std::size_t n, R* mix) {
                 texture::marble_row(marble, s.look.bounded, rows, n, mix);
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

NodeType nodes::texture_marble() {
  return pixel_node("texture.marble", prepare, tile)
      .doc("Colours points by layers of marble: a sine across them, its phase moved by turbulence.")
      .cite(
          "Perlin 1985, An Image Synthesizer, doi:10.1145/325165.325247; errata E19: textures need not be "
          "images")
      .covers(30)
      .input("points", &Inputs::points,
             "Visible points with uv or world positions; transparent black where none is.")
      .param("domain", &Params::domain,
             "Layers over the surface's uv, or in the world, which the surface cuts.")
      .param("axis", &Params::axis, "Across the layers; its length scales their number.")
      .param("scale", &Params::scale, "Layers a unit; raising it makes them finer.", {.range = above(0)})
      .param("bend", &Params::bend, "How many layers turbulence moves them; raising it tangles the veins.",
             {.unit = "layers", .range = at_least(0)})
      .param("octaves", &Params::octaves, "Octaves of turbulence; raising it adds finer detail.",
             {.range = between(1, 24)})
      .knob({"1", "2", "4", "6", "8", "12"}, "Each octave left out leaves out detail of half the height.")
      .param("bounded", &Params::bounded,
             "Whether layers and octaves finer than a pixel fade to their mean; without it they alias.")
      .knob({"false", "true"}, "What a pixel cannot resolve is noise from pixel to pixel, and flickers.")
      .param("low", &Params::low, "Colour of the veins, linear Rec.709.", {.range = at_least(0)})
      .param("high", &Params::high, "Colour between them, linear Rec.709.", {.range = at_least(0)})
      .output("image", &Outputs::image,
              "Colour at every sample, linear Rec.709, premultiplied; albedo for shading.")
      .seen(seen_without_ids<State>)
      .blank_where(&Inputs::points);
}

}  // namespace frustum
