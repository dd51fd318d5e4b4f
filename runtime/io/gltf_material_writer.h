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
// Base colour is the diffuse one, metallic 0 and roughness (2 / (shininess + 2))^(1/4); "extras" hold the numbers of
// ours, which the reader takes as long as nobody has changed those. Cutoffs are MASK, emission above 1 is
// KHR_materials_emissive_strength, and KHR_materials_unlit and KHR_texture_transform say what they say here. A texture
// is a PNG of its finest level in sRGB, 8 bits a channel where these give every texel back, else 16: level, wraps and
// coordinates come back. Left out, and said so: checkerboards, maps of coordinates with shear, and colours above 1 of
// texels.
void write_materials(std::span<const Material> materials, std::span<const std::optional<double>> opacity,
                     const AddPicture& add, const SaveRequest& request, Json& document);

// The base colour and roughness that stand for a material.
glm::dvec3 written_base_color(const Material&);
double written_roughness(const Material&);

}  // namespace frustum::gltf
