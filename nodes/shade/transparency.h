// Which faces let what is behind them show, and how much.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace frustum {

// Gives `value` to every face, or to those of one material; the others keep theirs.
//   material  of each face; may be empty where `only` is not set
// Returns how many faces got it.
template <class R>
std::size_t set_transparency(std::span<R> faces, std::span<const std::uint32_t> material,
                             std::optional<std::uint32_t> only, R value) {
  std::size_t n = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (only && material[f] != *only) continue;
    faces[f] = value;
    ++n;
  }
  return n;
}

}  // namespace frustum
