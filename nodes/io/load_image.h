// What is taken of a picture file: one of its layers, and the colour space that its author knows better.
#pragma once

#include "runtime/buffers/image.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// The same planes with the colours taken as of `space`: no number changes. The planes are copied.
inline Raster relabelled(const Raster& from, std::string space) {
  Frame f = from.frame();
  f.color_space = std::move(space);
  const Raster to(std::move(f));
  copy(from.view(), to.view());
  return to;
}

inline bool is_main_plane(std::string_view plane) {
  return plane == "R" || plane == "G" || plane == "B" || plane == "A";
}

// The layer that a plane of an EXR file belongs to: what stands before its last dot; without one, the main
// layer "" for R, G, B and A, else a layer of its own name ("Z").
inline std::string_view layer_of(std::string_view plane) {
  const std::size_t dot = plane.rfind('.');
  if (dot != std::string_view::npos) return plane.substr(0, dot);
  return is_main_plane(plane) ? std::string_view{} : plane;
}

// Names of the layers, each once, in the order of the planes.
inline std::vector<std::string> layer_names(const PlaneList& planes) {
  std::vector<std::string> names;
  for (const Plane& p : planes)
    if (const std::string name(layer_of(p.name)); std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  return names;
}

// The planes of one layer, copied: colours lose its name ("albedo.R" is R), others keep theirs ("N.x").
// Colours that the file states no space for are lin_rec709, as real numbers are. Nothing where there is no
// such layer.
inline std::optional<Raster> take_layer(const Raster& from, std::string_view layer) {
  Frame f = from.frame();
  f.planes.clear();
  std::vector<int> source;
  for (std::size_t p = 0; p < from.frame().planes.size(); ++p) {
    Plane plane = from.frame().planes[p];
    if (layer_of(plane.name) != layer) continue;
    const std::string last = plane.name.substr(plane.name.rfind('.') + 1);
    if (is_main_plane(last)) plane.name = last;
    f.planes.push_back(std::move(plane));
    source.push_back(static_cast<int>(p));
  }
  if (source.empty()) return {};
  const bool color = f.find("R") && f.find("G") && f.find("B");
  if (!color)
    f.color_space.clear();
  else if (f.color_space.empty())
    f.color_space = "lin_rec709";
  f.alpha = f.find("A") ? Alpha::premultiplied : Alpha::none;
  const Raster to(f);
  const Tile in = from.view(), out = to.view();
  for (int p = 0; p < static_cast<int>(source.size()); ++p)
    for (int y = f.window.y0; y < f.window.y1; ++y) {
      const int plane = source[static_cast<std::size_t>(p)];
      if (f.planes[static_cast<std::size_t>(p)].kind == PlaneKind::u32)
        std::copy_n(in.row<const std::uint32_t>(plane, 0, y), f.window.width(),
                    out.row<std::uint32_t>(p, 0, y));
      else
        std::copy_n(in.row<const float>(plane, 0, y), f.window.width(), out.row<float>(p, 0, y));
    }
  return to;
}

}  // namespace frustum
