// Materials of a glTF file as ours.
#pragma once

#include "runtime/core/context.h"
#include "runtime/io/file_materials.h"
#include "runtime/io/gltf_data.h"
#include "runtime/io/gltf_notes.h"

#include <cstdint>
#include <span>

namespace frustum::gltf {

// The materials with the numbers `used`, in that order, with their textures where `textures` is set. How the
// metallic-roughness model becomes a Blinn lobe (glTF 2.0, appendix B; Walter et al. 2007, EGSR, "Microfacet
// models for refraction", eq. 30; Karis 2013, "Real shading in Unreal Engine 4"):
//
//   F0         = f + (base - f) metallic, of the base colour factor, where f is 0.04, that of an index of 1.5, or
//                what KHR_materials_ior and KHR_materials_specular say
//   diffuse    = base (1 - metallic) (1 - max f): what the surface lets in at normal incidence
//   shininess  = 2 / alpha^2 - 2 with alpha = roughness^2: the exponent n for which D = (n + 2) / (2 pi)
//                cos^n h is as wide as the GGX lobe; rounded, and at most 1024
//   specular   = F0 (n + 2) / 8: the microfacet lobe D F G / (4 n.l n.v) under a light of colour 1 (which is
//                an irradiance of pi) with G = n.l n.v, at its peak
//
// The reflectance of that lobe at normal incidence is F0 (n + 2^(-n/2)) / (n + 4) <= F0, so a mapped material
// never sends back more than it gets. A texture scales the diffuse part alone. A metallic-roughness texture
// counts as the mean of its texels. Unlit materials keep their colour whatever the light. What does not map
// is noted once a kind.
//
// Alpha (glTF 2.0, 3.9.4) is the product of base colour factor, texture and vertex colour:
//   OPAQUE  none of it counts: textures lose theirs
//   BLEND   the factor is the opacity of the faces; texture and vertices keep theirs
//   MASK    the texture's alpha_cutoff is alphaCutoff / factor, for what texture and vertices leave to decide; above 1
//           (no alpha reaches it) it is 2. Without a texture the factor decides, for all of a face
//
// Materials that were written here (gltf_material_writer.h) come back as they were.
//
// Pictures are decoded and their pyramids made in parallel, each once however often it is used. Throws
// NodeError("malformed_file") and WorldError("cannot_read_file") naming the image's element.
FileMaterials read_materials(const Object& document, const FilePath& file, Data& data,
                             std::span<const std::size_t> used, bool textures, Notes& notes, Context& ctx);

enum class AlphaMode : std::uint8_t { opaque, mask, blend };
// Throws NodeError("malformed_file") where it is none of the three.
AlphaMode alpha_mode(const Object& material);

// Whether the file gives the material a base colour texture, read or not.
bool has_color_texture(const Object& material);

}  // namespace frustum::gltf
