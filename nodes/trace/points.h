// The attributes of what rays have met.
#pragma once

#include "nodes/kernels/interpolate_attributes.h"
#include "nodes/kernels/ray_beam.h"

namespace frustum::trace {

// The corners of a face.
template <std::floating_point R>
std::array<glm::dvec3, 3> corners_of(std::span<const glm::vec<3, R>> position, const glm::uvec3& face) {
  return {glm::dvec3(position[face.x]), glm::dvec3(position[face.y]), glm::dvec3(position[face.z])};
}

}  // namespace frustum::trace
