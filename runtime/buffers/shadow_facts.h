// Which lights may be hidden from what is seen: facts from which nodes that find shadows decide their effect.
#pragma once

#include "nodes/kernels/lighting.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/effect.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace frustum {

// What is seen, and what may stand between it and a light; world space.
struct ShadowScene {
  std::span<const glm::dvec3> seen;
  std::span<const glm::uvec3> faces;    // of seen
  std::span<const glm::dvec3> casters;  // vertices
};

// By source: a witness that it may be hidden from somewhere, or empty where every point of every face is sure to
// see it. It is where it stands well in front of all faces, and no caster stands in front of any: each face's front is
// then free, however the light stands. Signs are exact.
// Cost: up to 2^20 signs in all, from where on a source counts as one that may be hidden.
std::vector<std::string> witnesses_of_shadow(const ShadowScene&,
                                             std::span<const kernels::LightSource<double>>);

// The verdict on all sources together: on where one has a witness.
//   points  that are lit, were every pixel to show one face
Verdict needs_shadows(std::span<const std::string> witnesses, std::size_t caster_faces, std::uint64_t points);

}  // namespace frustum
