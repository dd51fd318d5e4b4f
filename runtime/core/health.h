// Numeric health: NaN and infinities are counted wherever buffers are published, and the first place is named.
#pragma once

#include "runtime/core/raster.h"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace frustum {

// Counts of what should not be there, and where the first of it is ("column position, vertex 17"; "plane Z, pixel 3,4").
struct Health {
  std::uint64_t values = 0, nan = 0, positive_infinity = 0, negative_infinity = 0;
  std::string first = {};
  std::optional<std::pair<int, int>> pixel = {};  // x, y of the first, where it is a pixel
  bool finite() const { return nan + positive_infinity + negative_infinity == 0; }
  void add(const Health& more) {
    if (finite()) first = more.first, pixel = more.pixel;
    values += more.values, nan += more.nan;
    positive_infinity += more.positive_infinity, negative_infinity += more.negative_infinity;
  }
};

// Of every stored real plane of a tile; `first` names the plane, sample and pixel, in the order planes, samples, rows.
// Cost: one read of the tile; the exponent tests vectorise.
Health health_of(const Tile&);

}  // namespace frustum
