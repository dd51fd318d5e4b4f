// What a surface is made of.
#pragma once

#include "runtime/core/buffer.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace frustum {

enum class Reflection : std::uint8_t { lambert, phong, blinn };
constexpr auto choices(Reflection) {
  return std::array{std::pair{Reflection::lambert, "lambert"}, std::pair{Reflection::phong, "phong"},
                    std::pair{Reflection::blinn, "blinn"}};
}

// Coefficients are linear Rec.709; diffuse + specular above 1 makes energy, which is reported and not
// forbidden.
struct Material {
  std::string name = {};
  Reflection model = Reflection::blinn;
  glm::dvec3 ambient{1};  // scales the ambient lights, with the diffuse colour
  glm::dvec3 diffuse{0.8};
  glm::dvec3 specular{0};
  double shininess = 32;  // exponent of the lobe, >= 0
};

struct MaterialSet {
  std::vector<Material> materials;
};

template <>
const BufferType& buffer_type<Material>();

}  // namespace frustum
