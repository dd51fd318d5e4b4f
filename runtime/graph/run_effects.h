// Work of a run itself that nobody asks for, forced by the same policy as the effects of nodes.
#pragma once

#include <string_view>

namespace frustum {

// Planes of pixels that no node reads and no file holds; outputs of geometry nodes that nobody reads; pixels that show
// nothing, of nodes that are blank there.
inline constexpr std::string_view unread_planes = "unread_planes", unused_outputs = "unused_outputs",
                                  blank_pixels = "blank_pixels";

}  // namespace frustum
