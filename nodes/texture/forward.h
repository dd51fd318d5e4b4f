// The forward texture map: every texel goes to the pixel that its middle falls into.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "nodes/kernels/quad_map.h"

namespace frustum::texture {

// What became of a texture of width x height texels, of each of which density x density points are sent.
struct Landing {
  std::uint64_t points = 0, outside = 0;  // sent; fallen beside the picture
  std::uint64_t pixels = 0, holes = 0;    // that the quadrilateral owns; of these, those that nothing reached
  std::uint64_t overwrites = 0;           // points that fell on a pixel that had one
};

// Calls put(pixel index, texel x, texel y) for every point that falls into the picture, row by row of the
// texture, from the top; `hits` (size.x x size.y, row by row) counts them. Row 0 of texels is v = 1. Points
// on the border of two pixels go right and down. Cost: some 20 ns a point, whatever the size of the picture.
template <class Put>
Landing land(const kernels::QuadMap& map, const glm::ivec2& texels, int density, const glm::ivec2& size,
             std::vector<std::uint32_t>& hits, const Put& put) {
  Landing all;
  const auto coordinate = [&](int texel, int part, int count) {
    return (static_cast<double>(texel) + (part + 0.5) / density) / count;
  };
  for (int row = 0; row < texels.y * density; ++row) {
    const double v = 1 - coordinate(row / density, row % density, texels.y);
    for (int column = 0; column < texels.x * density; ++column) {
      const glm::dvec2 at = map.pixel_of({coordinate(column / density, column % density, texels.x), v});
      ++all.points;
      if (!(at.x >= 0 && at.y >= 0 && at.x < size.x && at.y < size.y)) {
        ++all.outside;
        continue;
      }
      const std::size_t pixel =
          static_cast<std::size_t>(at.y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(at.x);
      all.overwrites += hits[pixel]++ > 0 ? 1 : 0;
      put(pixel, column / density, row / density);
    }
  }
  return all;
}

// Counts the pixels whose middle the quadrilateral owns, and those of them without a hit, which `hole` is
// told of.
template <class Hole>
void count_holes(const kernels::QuadMap& map, const glm::ivec2& size, const std::vector<std::uint32_t>& hits,
                 Landing& all, const Hole& hole) {
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      if (!map.contains({x + 0.5, y + 0.5})) continue;
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(size.x) + static_cast<std::size_t>(x);
      ++all.pixels;
      if (hits[pixel] != 0) continue;
      ++all.holes;
      hole(pixel);
    }
}

}  // namespace frustum::texture
