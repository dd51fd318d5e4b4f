#include "runtime/buffers/transparency.h"

#include "runtime/buffers/texture_facts.h"

namespace frustum {
namespace {

bool is_opaque(const Material& m) { return m.texture == nullptr || !may_be_clear(*m.texture); }

void clear_transparent(const Mesh& mesh, std::vector<std::uint8_t>& opaque) {
  const Column* transparency = transparency_of(mesh);
  for (std::size_t f = 0; f < opaque.size() && transparency != nullptr; ++f)
    if (!(transparency->number(f, 0) <= 0)) opaque[f] = 0;
}

void clear_materials(const Mesh& mesh, std::vector<std::uint8_t>& opaque) {
  if (!mesh.materials || mesh.materials->materials.empty()) return;
  std::vector<std::uint8_t> material;
  for (const Material& m : mesh.materials->materials) material.push_back(is_opaque(m) ? 1 : 0);
  if (std::find(material.begin(), material.end(), 0) == material.end()) return;
  const Column* column = mesh.find("material");
  const auto of = column == nullptr ? std::span<const std::uint32_t>() : column->values<std::uint32_t>();
  for (std::size_t f = 0; f < opaque.size(); ++f) {
    const std::size_t m = of.empty() ? 0 : of[f];
    if (m < material.size() && material[m] == 0) opaque[f] = 0;
  }
}

void clear_vertices(const Mesh& mesh, std::vector<std::uint8_t>& opaque) {
  const Column* color = mesh.find("color");
  if (color == nullptr || color->width() != 4) return;
  const bool by_corner = color->domain() == Domain::corner;
  const auto triangles = mesh.triangles();
  for (std::size_t f = 0; f < opaque.size(); ++f)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t row = by_corner ? 3 * f + c : triangles[f][static_cast<glm::length_t>(c)];
      if (!(color->number(row, 3) >= 1)) opaque[f] = 0;
    }
}

}  // namespace

std::vector<std::uint8_t> opaque_faces(const Mesh& mesh, const Material* material, const Texture* texture) {
  std::vector<std::uint8_t> opaque(mesh.faces(), 1);
  clear_transparent(mesh, opaque);
  if (texture != nullptr) {
    if (may_be_clear(*texture)) opaque.clear();
  } else if (material != nullptr && !is_opaque(*material)) {
    opaque.clear();
  } else {
    if (material == nullptr) clear_materials(mesh, opaque);
    clear_vertices(mesh, opaque);
  }
  if (std::find(opaque.begin(), opaque.end(), 1) == opaque.end()) opaque.clear();
  return opaque;
}

}  // namespace frustum
