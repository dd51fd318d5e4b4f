// The text of an MTL file, statement by statement.
#pragma once

#include "runtime/core/param.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace frustum::mtl {

// A material as its file says it.
struct Written {
  std::optional<glm::dvec3> kd, ka, ks, ke;
  std::optional<double> ns, d, tr;  // d and tr within [0, 1]
  int illum = 2;
  std::string map_kd;
  std::string map_place;  // file:line
  bool clamp = false;
  glm::dvec2 scale{1}, offset{0};
};

using Library = std::map<std::string, Written, std::less<>>;
// Statements, and how many of each.
using Counts = std::map<std::string, std::uint64_t>;

// What a file says and its materials do not have.
struct Told {
  Counts skipped;       // without a counterpart here
  Counts held;          // values beyond what a material may have, which became the nearest one it may
  std::string held_at;  // file:line of the first of those
};

// Adds the materials of a file to a library; the first definition of a name counts. Colours are at least 0, and
// Ns lies within [0, 1e6], what shade.material takes. Throws NodeError("malformed_file") with file:line.
void parse(std::string_view text, const FilePath& file, Library& library, Told& told);

}  // namespace frustum::mtl
