// What nodes that make cameras let their users choose alike: whose conventions hold.
#pragma once

#include "runtime/buffers/camera.h"
#include "runtime/core/error.h"

#include <fmt/format.h>

#include <string>
#include <string_view>

namespace frustum {

inline constexpr std::string_view
    conventions_doc =
        "Whose depth range, direction of y in clip space, and corner that flat faces take their values from.",
    conventions_basis = "The same picture, by other numbers on the way there.",
    reversed_z_doc = "Depth falls from 1 at near to 0 at far, which resolves far distances better.",
    reversed_z_basis = "In single precision, steps of depth grow like z^2 one way and like z the other.",
    subpixel_bits_doc =
        "Corners of triangles snap to 2^-bits px; raising it keeps them truer. Direct3D has 8.",
    subpixel_bits_basis = "Corners are off by up to half a step, 2^-(bits + 1) px.";

// Throws NodeError("impossible_camera") at the parameter of that name.
inline void check_subpixel_bits(Conventions conventions, int bits) {
  if (conventions == Conventions::d3d && bits != 8)
    throw NodeError("impossible_camera",
                    "Direct3D snaps corners to 8 bits below a pixel, no more and no fewer",
                    at_param("subpixel_bits"));
}

// What holds for the pictures of such a camera, as `frustum plan` says it.
inline std::string stated(Conventions conventions, bool reversed_z, int subpixel_bits) {
  const kernels::ClipSpace space = clip_space(conventions, reversed_z);
  return fmt::format(
      "{}: depth {} to {}, y of clip space {}, the {} corner of a face provokes, corners snap to 1/{} px; "
      "standard samples are those of Vulkan and Direct3D{}",
      choices(conventions)[static_cast<std::size_t>(conventions)].second, kernels::near_depth(space.depth),
      kernels::far_depth(space.depth), space.y_down ? "down" : "up",
      provoking_corner(conventions) == 0 ? "first" : "last", 1 << subpixel_bits,
      conventions == Conventions::gl ? ", since OpenGL leaves them open" : "");
}

}  // namespace frustum
