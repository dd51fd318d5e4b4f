// Our materials as those of a glTF file.
#pragma once

#include "runtime/buffers/material.h"
#include "runtime/core/sink.h"

#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace frustum::gltf {

// Keeps the bytes of a picture in the file and gives the number of their buffer view.
using AddPicture = std::function<std::size_t(std::string png)>;

// Adds "materials" to the document, and what they use: "textures", "images", "samplers", "extensionsUsed".
//   opacity  of each material's faces; nothing: all of them hide what is behind (alphaMode OPAQUE)
//
// Roughness is (2 / (shininess + 2))^(1/4), and what the surface mirrors straight on is F0 = 8 specular / (shininess + 2),
// which is what the reader makes highlights of. A material with a highlight and no diffuse colour is a metal of base
// colour F0. Others have metallic 0, base colour diffuse / (1 - F0) and KHR_materials_specular where F0 is not that of
// glTF, 0.04. "extras" hold the numbers of ours, which the reader takes as long as nobody has changed those. Cutoffs are MASK, emission above 1 is
// KHR_materials_emissive_strength, and KHR_materials_unlit and KHR_texture_transform say what they say here. A texture
// is a PNG of its finest level in sRGB, 8 bits a channel where these give every texel back, else 16: level, wraps and
// coordinates come back. Left out, and said so: checkerboards, maps of coordinates with shear, colours above 1 of
// texels, and the light that a material sends back beyond what falls on it.
void write_materials(std::span<const Material> materials, std::span<const std::optional<double>> opacity,
                     const AddPicture& add, const SaveRequest& request, Json& document);

// The numbers of glTF that stand for a material, but for its texture, opacity and emission.
struct Surface {
  glm::dvec3 base{1};
  double metallic = 0, roughness = 1;
  glm::dvec3 specular{1};  // F0 of what is no metal, by 0.04: specularColorFactor
  bool limited = false;    // the material sends back more light than these do, which is more than falls on it
};
Surface surface_of(const Material&);

}  // namespace frustum::gltf
