// Names that columns of a mesh have here, and files may use for something else.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace frustum {

// Whether a column of that name means something to a node, whatever a file means by it.
inline bool has_meaning(std::string_view name) {
  // Columns of a mesh, and planes that rasterize.attributes gives besides.
  static constexpr std::array names{"triangle", "position", "normal", "color", "world", "origin",
                                    "material", "id",       "w",      "z",     "R",     "G",
                                    "B",        "A",        "N",      "P"};
  return std::find(names.begin(), names.end(), name) != names.end() || name.starts_with("uv");
}

}  // namespace frustum
