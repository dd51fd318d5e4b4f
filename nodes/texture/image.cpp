#include "nodes/texture/image.h"

#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/core/node_type.h"
#include "runtime/io/color.h"
#include "runtime/io/image_texture.h"

namespace frustum {
namespace {

enum class Storage : std::uint8_t { single, half };
constexpr auto choices(Storage) {
  return std::array{std::pair{Storage::single, "single"}, std::pair{Storage::half, "half"}};
}

struct Inputs {
  Ref<Image> image;
};
struct Params {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool pyramid = true;
  Storage storage = Storage::single;
  double alpha_cutoff = 0;
};
struct Outputs {
  Ref<Texture> texture;
};

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  auto texture = make_texture(in.image->raster,
                              {.wrap_u = p.wrap_u,
                               .wrap_v = p.wrap_v,
                               .pyramid = p.pyramid,
                               .alpha_cutoff = p.alpha_cutoff,
                               .half = p.storage == Storage::half},
                              ctx);
  const Rect window = in.image->raster.frame().window;
  ctx.count("levels",
            p.pyramid ? static_cast<std::uint64_t>(pyramid_levels(window.width(), window.height())) : 1);
  return {std::move(texture)};
}

}  // namespace

NodeType nodes::texture_image() {
  NodeType type =
      node("texture.image", run)
          .doc("Makes a texture of an image: linear light, with a pyramid of halves for filtering.")
          .cite("Williams 1983, Pyramidal parametrics")
          .covers(30)
          .foreign()
          .input("image", &Inputs::image,
                 "R, G, B (or one plane, taken as grey) and A, converted from the image's colour space.")
          .param("wrap_u", &Params::wrap_u, "What lies beyond u = 0 and 1; border is transparent black.")
          .param("wrap_v", &Params::wrap_v, "What lies beyond v = 0 and 1; border is transparent black.")
          .param("pyramid", &Params::pyramid,
                 "Whether smaller levels are made, which trilinear lookup needs; a third more memory.")
          .param("storage", &Params::storage,
                 "What texels are kept in: half has 11 bits, up to 65504, and reads half as much memory.")
          .knob({"half", "single"}, "Each texel of half is off by at most 2^-11 of itself.")
          .param(
              "alpha_cutoff", &Params::alpha_cutoff,
              "Above 0, what is looked up with less opacity is not there, and the rest is opaque; 0 blends.",
              {.range = between(0, 1)})
          .output("texture", &Outputs::texture, "The texture; the top row of the image is at v = 1.");
  depend_on_color_environment(type);
  return type;
}

}  // namespace frustum
