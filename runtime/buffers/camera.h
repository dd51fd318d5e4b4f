// Where the picture is taken from.
#pragma once

#include "runtime/core/buffer.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace frustum {

// Right-handed; the camera looks along -z of eye space, y up. Distances in world units.
struct Camera {
  glm::dvec3 eye{0, 0, 5}, target{0}, up{0, 1, 0};
  double fov_y = 0.6108652381980153;  // radians: 35 degrees
  double near_z = 0.1,
         far_z = 1000;      // distances along the view axis, 0 < near_z < far_z; far_z may be infinite
  double height = 2;        // of the view volume of an orthographic projection, world units
  bool reversed_z = false;  // depth falls from 1 at near_z to 0 at far_z
  glm::ivec2 resolution{1280, 720};  // pixels, width and height

  double aspect() const { return static_cast<double>(resolution.x) / resolution.y; }
};

template <>
const BufferType& buffer_type<Camera>();

}  // namespace frustum
