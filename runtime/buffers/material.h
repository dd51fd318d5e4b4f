// What a surface is made of.
#pragma once

#include "runtime/core/archive.h"
#include "runtime/core/buffer.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frustum {

class Texture;

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
  double shininess = 32;          // exponent of the lobe, >= 0
  glm::dvec3 emission{0};         // light of its own, added to what it reflects
  bool two_sided = false;         // its back is shaded as if turned around, and never culled
  bool unlit = false;             // shows its diffuse colour and texture whatever the light
  Ref<Texture> texture = {};      // scales ambient and diffuse, in texture.sample; null: none
  std::uint32_t uv_set = 0;       // which coordinates the texture takes: 0 column "uv", 1 "uv1", 2 "uv2" ...
  glm::dmat3 texture_from_uv{1};  // affine, on (u, v, 1): the place in the texture
};

struct MaterialSet {
  std::vector<Material> materials;
};

// Pieces of a BufferType for whatever holds materials; a texture that several share counts once.
std::size_t bytes_of(const MaterialSet&);
void hash_materials(const MaterialSet&, Hasher&);
Health health_of_materials(const MaterialSet&);
void visit_textures(const MaterialSet&, const std::function<void(const void* storage, std::size_t bytes)>&);

void save_materials(const MaterialSet&, ArchiveWriter&);
MaterialSet load_materials(ArchiveReader&);

// The name of the column that holds a set of texture coordinates: "uv", "uv1", "uv2" ...
std::string uv_column_name(std::uint32_t set);
bool is_uv_column(std::string_view name);

template <>
const BufferType& buffer_type<Material>();

}  // namespace frustum
