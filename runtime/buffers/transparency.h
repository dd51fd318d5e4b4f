// How much of what lies behind a face shows through it: a column of the mesh, so that it goes where faces go, and the
// opacity of its vertices and of its material's texture.
#pragma once

#include "runtime/buffers/mesh.h"

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace frustum {

// One real number a face, 0 (opaque) to 1 (not there). A mesh without it is opaque, and so are the faces of parts
// without it when meshes are merged.
constexpr std::string_view transparency_column = "transparency";

// The column, or null where no face has one. Throws NodeError("wrong_column") where it is not one real number a face.
inline const Column* transparency_of(const Mesh& mesh) {
  const Column* c = mesh.find(transparency_column);
  if (c == nullptr) return nullptr;
  const bool real = c->kind() == NumberKind::f32 || c->kind() == NumberKind::f64;
  if (c->domain() != Domain::face || c->width() != 1 || !real)
    throw NodeError("wrong_column", "column transparency is one real number a face", at_input("mesh"));
  return c;
}

// 1 - transparency by face, within [0, 1]; empty where no face has one.
template <class R>
std::vector<R> opacities_of(const Mesh& mesh) {
  std::vector<R> opacity;
  if (const Column* c = transparency_of(mesh))
    for (std::size_t f = 0; f < c->rows(); ++f)
      opacity.push_back(std::clamp(R(1) - static_cast<R>(c->number(f, 0)), R(0), R(1)));
  return opacity;
}

// By face 1 where nothing behind it can show, else 0; empty where no face is opaque. What texture.sample and
// shade.surface multiply decides: the column, the texture of the face's material, and the colours of its vertices.
//   material  for all faces, instead of the mesh's own; may be null
//   texture   for all faces, instead of materials' textures and vertex colours; may be null
// NaN counts as not opaque. Cost: linear in faces and vertices, and up to 2^16 texels a texture.
std::vector<std::uint8_t> opaque_faces(const Mesh&, const Material* material = nullptr,
                                       const Texture* texture = nullptr);

}  // namespace frustum
