#include "runtime/buffers/texels.h"

#include "runtime/core/error.h"

namespace frustum {

std::vector<kernels::TexelLevel> texel_levels(const Texture& texture) {
  std::vector<kernels::TexelLevel> levels;
  const auto* pyramid = std::get_if<MipPyramid>(&texture.source);
  if (pyramid == nullptr) return levels;
  if (pyramid->levels.empty() || pyramid->levels.size() > 32)
    throw NodeError("empty_texture", "the texture has no level or too many", at_input("texture"));
  for (const MipPyramid::Level& l : pyramid->levels) {
    if (l.width < 1 || l.height < 1)
      throw NodeError("empty_texture", "the texture has no texels", at_input("texture"));
    const bool half = !l.half_rgba.empty();
    levels.push_back(
        {l.width, l.height, half ? nullptr : l.rgba.data(), half ? l.half_rgba.data() : nullptr});
  }
  return levels;
}

}  // namespace frustum
