// A camera on a circle around a ball.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/vector.h"

namespace frustum::scene {

// Direction from the centre to the camera in the given frame of a turn of `frames`: at 0 degrees +z, at 90
// degrees +x, elevation degrees above the horizon. Frames repeat exactly: frame and frame + frames are the
// same camera. Requires frames > 0.
inline glm::dvec3 orbit_direction(std::int64_t frame, std::int64_t frames, double start_deg,
                                  double elevation_deg) {
  const double part = static_cast<double>((frame % frames + frames) % frames) / static_cast<double>(frames);
  const auto around = kernels::sin_cos_degrees(std::fmod(start_deg, 360) + 360 * part);
  const auto up = kernels::sin_cos_degrees(elevation_deg);
  return {around.sin * up.cos, up.sin, around.cos * up.cos};
}

// How far from its centre a ball is seen whole in a perspective picture with `margin` times its radius from
// the middle to the nearer border: by the tangent planes through the border. Requires 0 < fov_y < pi,
// aspect > 0.
inline double orbit_distance(double radius, double margin, double fov_y, double aspect) {
  const double tan_y = kernels::tan(fov_y / 2), tan_x = tan_y * aspect;
  const double least = std::min(tan_x, tan_y);
  const double sine = least / std::sqrt(1 + least * least);
  return margin * radius / sine;
}

// Planes before and behind everything in the ball, with a hair to spare.
struct DepthRange {
  double near_z, far_z;
};
inline DepthRange orbit_depths(double distance, double radius) {
  return {std::max(distance - 1.01 * radius, distance * 1e-3), distance + 1.01 * radius};
}

}  // namespace frustum::scene
