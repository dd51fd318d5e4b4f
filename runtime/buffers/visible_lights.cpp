#include "runtime/buffers/visible_lights.h"

#include <fmt/format.h>

namespace frustum {

std::vector<RealPlane> read_visible_lights(const Tiled<Image>& visibility, std::size_t sources,
                                           Precision precision) {
  const Frame& f = visibility.frame();
  std::vector<RealPlane> reach(sources);
  std::size_t found = 0;
  for (std::size_t i = 0; i < sources; ++i) {
    if (!f.find(visibility_plane(i))) continue;
    reach[i] = read_real(visibility, visibility_plane(i), precision), ++found;
  }
  if (found != f.planes.size())
    throw NodeError(
        "other_lights",
        fmt::format("'visibility' has {} planes, of which {} are of one of the {} sources of light",
                    f.planes.size(), found, sources),
        at_input("visibility"));
  return reach;
}

}  // namespace frustum
