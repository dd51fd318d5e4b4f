// How many texels a pixel of a picture sees at most, before there are any pixels.
#pragma once

#include "runtime/buffers/mesh.h"
#include "runtime/buffers/texture.h"

#include <glm/mat3x3.hpp>

#include <cstdint>
#include <optional>

namespace frustum {

// Where a texture lies on a mesh: by which coordinates, moved how, and on faces of which material (of all, if
// none is named).
struct Skinning {
  std::uint32_t uv_set = 0;
  glm::dmat3 texture_from_uv{1};
  std::optional<std::uint32_t> material;
};

// The first face on which a pixel may see more than `texels` of level 0 along x or y, by
// kernels::greatest_uv_slope; nothing where no pixel of a picture of this mesh can. Nothing is known, and
// face 0 is named, of meshes that are not in screen space or lack the coordinates. Parallel; cost: some 100
// ns a face, up to the first one.
std::optional<std::size_t> first_minified_face(const Mesh& mesh, const MipPyramid& texture,
                                               const Skinning& skin, double texels);

}  // namespace frustum
