// The colour space of a picture that its author knows better than its file.
#pragma once

#include "runtime/buffers/image.h"

#include <string>

namespace frustum {

// The same planes with the colours taken as of `space`: no number changes. The planes are copied.
inline Raster relabelled(const Raster& from, std::string space) {
  Frame f = from.frame();
  f.color_space = std::move(space);
  const Raster to(std::move(f));
  copy(from.view(), to.view());
  return to;
}

}  // namespace frustum
