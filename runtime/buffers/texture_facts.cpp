#include "runtime/buffers/texture_facts.h"

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

bool has_border(const MipPyramid& p) { return p.wrap_u == Wrap::border || p.wrap_v == Wrap::border; }

}  // namespace

std::optional<std::array<float, 4>> constant_color(const Texture& t) {
  const auto* pyramid = std::get_if<MipPyramid>(&t.source);
  if (pyramid == nullptr || pyramid->levels.empty() || pyramid->levels[0].size() < 4 || has_border(*pyramid))
    return std::nullopt;
  std::array<float, 4> color{};
  for (std::size_t k = 0; k < 4; ++k) color[k] = pyramid->levels[0].number(k);
  for (const float c : color)
    if (!std::isfinite(c) || (c == 0 && std::signbit(c))) return std::nullopt;
  for (const MipPyramid::Level& level : pyramid->levels)
    for (std::size_t i = 0; i < level.size(); ++i) {
      const float n = level.number(i);
      if (n != color[i % 4] || std::signbit(n) != std::signbit(color[i % 4])) return std::nullopt;
    }
  return color;
}

bool may_be_clear(const Texture& t) {
  const auto* pyramid = std::get_if<MipPyramid>(&t.source);
  return (pyramid != nullptr && pyramid->alpha_cutoff > 1) || least_opacity(t) < 1 - 0x1p-20F;
}

float least_opacity(const Texture& t) {
  const auto* pyramid = std::get_if<MipPyramid>(&t.source);
  if (pyramid == nullptr || pyramid->levels.empty()) return 1;
  if (has_border(*pyramid)) return 0;
  constexpr std::size_t most_texels = std::size_t{1} << 16;
  const auto& levels = pyramid->levels;
  auto level = std::find_if(levels.begin(), levels.end(),
                            [](const MipPyramid::Level& l) { return l.size() <= 4 * most_texels; });
  if (level == levels.end()) level = levels.begin();  // without a pyramid there is but one
  float least = 1;
  for (std::size_t i = 3; i < level->size(); i += 4) least = std::min(least, level->number(i));
  return least;
}

}  // namespace frustum
