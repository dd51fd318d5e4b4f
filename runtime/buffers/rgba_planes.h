// The planes of a picture.
#pragma once

#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"

#include <array>

namespace frustum {

constexpr std::array<const char*, 4> rgba_names{"R", "G", "B", "A"};

// R, G, B and A, to be read by tile(); no A is opaque. Throws as read_real does.
inline std::array<RealPlane, 4> read_rgba(const Tiled<Image>& image, Precision precision) {
  std::array<RealPlane, 4> planes{};
  for (std::size_t k = 0; k < 4; ++k)
    if (k < 3 || image.frame().find("A")) planes[k] = read_real(image, rgba_names[k], precision);
  return planes;
}

}  // namespace frustum
