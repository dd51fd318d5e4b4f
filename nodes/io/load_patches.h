// Bezier patches from a JSON text.
#pragma once

#include "runtime/buffers/surface.h"

#include <string_view>

namespace frustum {

// Reads
//   { "format": "frustum.patches/1", "title": "...",
//     "points": [[x, y, z], ...], "patches": [[16 indices], ...] }
// where entry 4 i + j of a patch is the index of its control point in row i (u) and column j (v).
// `name` is what messages call the file. Throws NodeError("malformed_file") naming line or JSON pointer for
// text that is no JSON, unknown or missing keys, numbers that are not finite, indices beyond the points. No
// patches give an empty surface.
Surface parse_patches(std::string_view json, std::string_view name);

}  // namespace frustum
