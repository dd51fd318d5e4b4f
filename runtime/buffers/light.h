// Lights. Colours are linear Rec.709 radiance factors: a white Lambert surface facing a light of colour 1
// has colour 1.
#pragma once

#include "runtime/core/buffer.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace frustum {

struct Light {
  enum class Kind : std::uint8_t { ambient, directional, point, spot, area };
  Kind kind = Kind::ambient;
  glm::dvec3 color{1};
  glm::dvec3 direction{0, -1,
                       0};  // directional: the way the light travels; spot: the axis of its cone; world
                            // space, unit length
  glm::dvec3 position{0};   // point, spot: world space
  glm::dvec3 attenuation{1, 0, 0};  // point, spot: intensity is divided by x + y d + z d^2, d the distance
  double inner = 0,
         outer = 0;  // spot: angles from the axis, where the light starts to fade and where it ends
  // area: sides of a rectangle around `position`, which shines alike from everywhere to where edge_u x edge_v points;
  // its colour is what it looks like itself
  glm::dvec3 edge_u{0}, edge_v{0};
  std::uint32_t samples = 1;  // area: points that stand for it

  bool has_place() const { return kind == Kind::point || kind == Kind::spot || kind == Kind::area; }
};

// What one link carries: all the lights of a scene, or just one.
struct LightSet {
  std::vector<Light> lights;
};

inline Ref<LightSet> one_light(const Light& light) {
  return std::make_shared<const LightSet>(LightSet{{light}});
}

template <>
const BufferType& buffer_type<LightSet>();

}  // namespace frustum
