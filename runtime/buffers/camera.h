// Where the picture is taken from.
#pragma once

#include "nodes/kernels/camera.h"
#include "runtime/core/buffer.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace frustum {

// What an API settles about a picture, and others settle otherwise; docs/numerics.md has the table and its sources.
enum class Conventions : std::uint8_t { gl, vulkan, d3d };
constexpr auto choices(Conventions) {
  return std::array{std::pair{Conventions::gl, "gl"}, std::pair{Conventions::vulkan, "vulkan"},
                    std::pair{Conventions::d3d, "d3d"}};
}

// Right-handed; the camera looks along -z of eye space, y up. Distances in world units.
struct Camera {
  glm::dvec3 eye{0, 0, 5}, target{0}, up{0, 1, 0};
  double fov_y = 0.6108652381980153;  // radians: 35 degrees
  double near_z = 0.1,
         far_z = 1000;      // distances along the view axis, 0 < near_z < far_z; far_z may be infinite
  double height = 2;        // of the view volume of an orthographic projection, world units
  bool reversed_z = false;  // depth falls from 1 at near_z to 0 at far_z, in any API
  Conventions conventions = Conventions::gl;
  int subpixel_bits = 8;             // corners of triangles snap to 2^-subpixel_bits px, 4 to 8
  glm::ivec2 resolution{1280, 720};  // pixels, width and height

  double aspect() const { return static_cast<double>(resolution.x) / resolution.y; }
};

// Of an API; with `reversed_z` depth runs from 1 to 0 in each.
kernels::ClipSpace clip_space(Conventions conventions, bool reversed_z);
// Of a camera; that of OpenGL where there is none.
kernels::ClipSpace clip_space(const Camera* camera);

inline kernels::Viewport viewport_of(const Camera& c) {
  return kernels::Viewport(c.resolution, clip_space(&c).y_down);
}

// Which corner's values a face that is shaded flat has: its first or its last (index 2).
constexpr int provoking_corner(Conventions c) { return c == Conventions::gl ? 2 : 0; }

template <>
const BufferType& buffer_type<Camera>();

}  // namespace frustum
