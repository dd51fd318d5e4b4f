// What a file says of materials: as ours, and how opaque each is, which here is a property of faces.
#pragma once

#include "runtime/buffers/transparency.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

struct FileMaterials {
  MaterialSet set;
  std::vector<double> opacity;  // by material, 0 to 1
};

// Column "transparency" of faces with these materials; null where each is opaque. Requires material < opacity.size().
template <class R>
Ref<Column> transparency_by_material(std::span<const std::uint32_t> material,
                                     std::span<const double> opacity) {
  const auto clear = [&](std::uint32_t m) { return opacity[m] < 1; };
  if (std::none_of(material.begin(), material.end(), clear)) return nullptr;
  auto column = Column::make<R>(transparency_column, Domain::face, material.size());
  const auto out = column->template values<R>();
  for (std::size_t f = 0; f < material.size(); ++f) out[f] = static_cast<R>(1 - opacity[material[f]]);
  return column;
}

}  // namespace frustum
