// Textures from pictures: what texture.image and the readers of scenes have in common.
#pragma once

#include "runtime/buffers/texture.h"
#include "runtime/core/context.h"
#include "runtime/core/raster.h"

namespace frustum {

struct TextureOptions {
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  bool pyramid = true;      // smaller levels too, which trilinear lookup needs: a third more memory
  double alpha_cutoff = 0;  // of the pyramid
  bool half = false;        // numbers of 16 bits (nodes/kernels/half.h)
  bool opaque = false;  // the picture's alpha says nothing of the surface: colours become straight, alpha 1
};

// Level 0 is the picture in linear Rec.709, from its own colour space (none: linear Rec.709); every further
// level a half of the one before, by exact area averages of premultiplied colour.
//   picture   planes R, G, B or just one, taken as grey; A where it has one; one value a pixel
// Throws NodeError("sampled_image", "empty_image", "missing_plane", "wrong_plane_kind") for other pictures, and
// ("beyond_half") for numbers that 16 bits do not reach.
// Cost: about 10 ns a texel, in parallel; ctx is polled once a level.
Ref<Texture> make_texture(const Raster& picture, const TextureOptions&, Context& ctx);

}  // namespace frustum
