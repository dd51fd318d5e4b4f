// What nodes that make cameras let their users choose alike: whose conventions hold.
//
// Their Params have the members `conventions`, `subpixel_bits` and, where the direction of depth is a choice too,
// `reversed_z`; everything else about these is said here.
#pragma once

#include "runtime/buffers/camera.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

#include <string>

namespace frustum {

template <class Params>
concept ChoosesDepth = requires(const Params& p) {
  p.reversed_z;
};

// Declares the parameters after those that the node has so far; returns the node.
template <class I, class Params, class O>
NodeBuilder<I, Params, O>& camera_choices(NodeBuilder<I, Params, O>& node) {
  if constexpr (ChoosesDepth<Params>)
    node.param("reversed_z", &Params::reversed_z,
               "Depth falls from 1 at near to 0 at far, which resolves far distances better.")
        .knob_of_taste({"false", "true"},
                       "In single precision, steps of depth grow like z^2 one way and like z the other.");
  return node
      .param("conventions", &Params::conventions,
             "Whose depth range, direction of y in clip space, and corner that flat faces take their values "
             "from.")
      .knob_of_taste({"gl", "vulkan", "d3d"}, "The same picture, by other numbers on the way there.")
      .param("subpixel_bits", &Params::subpixel_bits,
             "Corners of triangles snap to 2^-bits px; raising it keeps them truer. Direct3D has 8.",
             {.range = between(4, 8)})
      .knob({"4", "5", "6", "7", "8"}, "Corners are off by up to half a step, 2^-(bits + 1) px.");
}

// Throws NodeError("impossible_camera") at the parameter that the conventions rule out.
template <class Params>
void check_camera_choices(const Params& p) {
  if (p.conventions == Conventions::d3d && p.subpixel_bits != 8)
    throw NodeError("impossible_camera",
                    "Direct3D snaps corners to 8 bits below a pixel, no more and no fewer",
                    at_param("subpixel_bits"));
}

// Writes the choices into a camera.
template <class Params>
void apply_camera_choices(const Params& p, Camera& c) {
  c.conventions = p.conventions, c.subpixel_bits = p.subpixel_bits;
  if constexpr (ChoosesDepth<Params>) c.reversed_z = p.reversed_z;
}

// What holds for the pictures of such a camera, as `frustum plan` says it.
template <class Params>
std::string stated_camera_choices(const Params& p) {
  Camera c;
  apply_camera_choices(p, c);
  const kernels::ClipSpace space = clip_space(&c);
  return fmt::format(
      "{}: depth {} to {}, y of clip space {}, the {} corner of a face provokes, corners snap to 1/{} px; "
      "standard samples are those of Vulkan and Direct3D{}",
      choices(c.conventions)[static_cast<std::size_t>(c.conventions)].second,
      kernels::near_depth(space.depth), kernels::far_depth(space.depth), space.y_down ? "down" : "up",
      provoking_corner(c.conventions) == 0 ? "first" : "last", 1 << c.subpixel_bits,
      c.conventions == Conventions::gl ? ", since OpenGL leaves them open" : "");
}

}  // namespace frustum
