// Patches under an affine map; points, normals and triangles are in nodes/kernels/move_points.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace frustum::transform {

// A mirrored patch keeps du x dv on its outer side once u and v change places.
inline std::array<std::uint32_t, 16> reversed(const std::array<std::uint32_t, 16>& patch) {
  std::array<std::uint32_t, 16> out{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) out[4 * j + i] = patch[4 * i + j];
  return out;
}

}  // namespace frustum::transform
