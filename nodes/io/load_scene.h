// What a scene file that has no camera or no lights is shown with.
#pragma once

#include "nodes/kernels/vector.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/light.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>

namespace frustum {

// A perspective of 35 degrees from the front right and above that sees the whole sphere around the box from
// `low` to `high` in either direction of the picture; depth reaches from a hundredth of the distance to twice
// the radius behind the sphere. A box without size counts as one of radius 1.
inline Camera fitted_camera(const glm::dvec3& low, const glm::dvec3& high, const glm::ivec2& resolution) {
  constexpr double tan_half = 0.31529878887898349;  // of 17.5 degrees
  Camera c;
  c.resolution = resolution;
  const glm::dvec3 diagonal = high - low;
  double radius = 0.5 * std::sqrt(kernels::dot(diagonal, diagonal));
  if (!(radius > 0) || !std::isfinite(radius)) radius = 1;
  const double tangent = tan_half * std::min(1.0, c.aspect());
  const double distance = radius * std::sqrt(1 + tangent * tangent) / tangent;  // radius / sin(atan(tangent))
  const glm::dvec3 towards_eye = kernels::normalized_or(glm::dvec3(0.6, 0.45, 1), glm::dvec3(0, 0, 1));
  c.target = (low + high) * 0.5;
  c.eye = c.target + towards_eye * distance;
  c.near_z = distance / 100, c.far_z = distance + 3 * radius;
  return c;
}

// One light over the left shoulder of whoever looks through the camera, and a little from everywhere.
inline LightSet usual_lights(const Camera& c) {
  const glm::dvec3 forward = kernels::normalized_or(c.target - c.eye, glm::dvec3(0, 0, -1));
  const glm::dvec3 right = kernels::normalized_or(kernels::cross(forward, c.up), glm::dvec3(1, 0, 0));
  const glm::dvec3 up = kernels::cross(right, forward);
  const glm::dvec3 travels = kernels::normalized_or(forward + right * 0.6 - up * 0.8, forward);
  return {{Light{.kind = Light::Kind::directional, .color = glm::dvec3(0.9), .direction = travels},
           Light{.kind = Light::Kind::ambient, .color = glm::dvec3(0.25)}}};
}

}  // namespace frustum
