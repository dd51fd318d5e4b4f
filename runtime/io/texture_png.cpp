#include "runtime/io/texture_png.h"

#include "runtime/core/raster.h"
#include "runtime/io/color.h"
#include "runtime/io/image_module.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace frustum {
namespace {

// Straight colours of a row in linear light, by channel.
void straight_row(const float* rgba, std::size_t width, const std::array<float*, 4>& to) {
  for (std::size_t x = 0; x < width; ++x) {
    const float a = rgba[4 * x + 3];
    for (std::size_t k = 0; k < 3; ++k) to[k][x] = a > 0 && a != 1 ? rgba[4 * x + k] / a : rgba[4 * x + k];
    if (to[3] != nullptr) to[3][x] = a;
  }
}

bool is_eight_bits(float v) {
  const float scaled = std::clamp(v, 0.0F, 1.0F) * 255;
  return std::abs(scaled - std::round(scaled)) <= 0x1p-6F;
}

}  // namespace

TexturePng texture_png(const MipPyramid& texture, std::string_view name) {
  const MipPyramid::Level& level = texture.levels.at(0);
  const auto width = static_cast<std::size_t>(level.width);
  bool opaque = true;
  for (std::size_t i = 3; i < level.size(); i += 4) opaque = opaque && level.number(i) == 1;
  Frame frame{.window = {0, 0, level.width, level.height},
              .planes = {{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}},
              .color_space = "srgb",
              .alpha = opaque ? Alpha::none : Alpha::straight};
  if (!opaque) frame.planes.push_back({"A", PlaneKind::f32});
  const Raster picture(std::move(frame));
  const Tile tile = picture.view();
  const ColorConversion conversion = ColorConfig::embedded().conversion("lin_rec709", "srgb");
  TexturePng out;
  bool eight = true;
  for (int y = 0; y < level.height; ++y) {
    std::array<float*, 4> row{};
    for (int k = 0; k < (opaque ? 3 : 4); ++k) row[static_cast<std::size_t>(k)] = tile.row<float>(k, 0, y);
    straight_row(level.numbers(4 * width * static_cast<std::size_t>(y), 4 * width).data(), width, row);
    conversion.apply(row[0], row[1], row[2], width);
    for (const float* channel : row)
      for (std::size_t x = 0; x < width && channel != nullptr; ++x) {
        out.clipped = out.clipped || !(channel[x] >= 0 && channel[x] <= 1 + 0x1p-20F);
        eight = eight && is_eight_bits(channel[x]);
      }
  }
  out.bytes = image_module().encode_png(picture, eight ? 8 : 16, name);
  return out;
}

}  // namespace frustum
