// Textures as pictures.
#pragma once

#include "runtime/buffers/texture.h"

#include <string>
#include <string_view>

namespace frustum {

struct TexturePng {
  std::string bytes;
  bool clipped = false;  // a texel had a colour outside [0, 1]
};

// A PNG of the finest level: sRGB, R G B, and straight A where a texel is not opaque; 8 bits a channel where they give
// back what make_texture (runtime/io/image_texture.h) makes of them, else 16. Requires a level with texels. Throws
// WorldError("no_image_module", "out_of_memory").
//   name  what messages call the file that gets it
TexturePng texture_png(const MipPyramid& texture, std::string_view name);

}  // namespace frustum
