// Which faces a new material goes to.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace frustum::mesh {

// of[f] = material for the faces first <= f < first + count whose present material m is chosen (chosen[m] is
// not 0). Returns how many there are. Requires the range within `of`.
inline std::size_t assign(std::span<std::uint32_t> of, std::size_t first, std::size_t count,
                          std::span<const std::uint8_t> chosen, std::uint32_t material) {
  std::size_t faces = 0;
  for (std::uint32_t& m : of.subspan(first, count)) {
    if (m >= chosen.size() || chosen[m] == 0) continue;
    m = material;
    ++faces;
  }
  return faces;
}

}  // namespace frustum::mesh
