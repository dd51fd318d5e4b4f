#include "runtime/buffers/minification.h"

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/screen_triangle.h"
#include "nodes/kernels/uv_slopes.h"
#include "runtime/buffers/screen_view.h"

namespace frustum {
namespace {

// Row of the column for each corner of a face.
std::optional<std::array<std::size_t, 3>> rows_of(const Column& c, std::size_t face,
                                                  const glm::uvec3& vertex) {
  switch (c.domain()) {
    case Domain::vertex: return std::array<std::size_t, 3>{vertex.x, vertex.y, vertex.z};
    case Domain::corner: return std::array<std::size_t, 3>{3 * face, 3 * face + 1, 3 * face + 2};
    default: return std::nullopt;
  }
}

}  // namespace

std::optional<std::size_t> first_minified_face(const Mesh& mesh, const MipPyramid& texture,
                                               const Skinning& skin, double texels) {
  constexpr std::size_t unknown = 0;
  const std::string name = uv_column_name(skin.uv_set);
  const Column *uv = mesh.find(name), *place = mesh.find("position");
  if (mesh.faces() == 0) return std::nullopt;
  const bool real = uv != nullptr && (uv->kind() == NumberKind::f32 || uv->kind() == NumberKind::f64);
  if (!real || uv->width() != 2 || place == nullptr || place->space() != Space::screen ||
      place->width() != 4 || !rows_of(*uv, 0, {}) || texture.levels.empty())
    return unknown;
  const auto wide_uv = mesh.real<double>(name), wide_place = mesh.real<double>("position");
  const auto coordinates = wide_uv->values<glm::dvec2>();
  const auto position = wide_place->values<glm::dvec4>();
  const auto triangle = mesh.triangles();
  const Column* materials = skin.material ? mesh.find("material") : nullptr;
  const auto material =
      materials != nullptr ? materials->values<std::uint32_t>() : std::span<const std::uint32_t>();
  const int corner_bits = corner_bits_of(mesh);
  const glm::dvec2 size(texture.levels[0].width, texture.levels[0].height);
  glm::dmat2 map(skin.texture_from_uv);
  for (glm::length_t c = 0; c < 2; ++c) map[c] *= size;
  const std::size_t face = kernels::first_where(mesh.faces(), [&](std::size_t i) {
    if (!material.empty() && material[i] != *skin.material) return false;
    const auto rows = *rows_of(*uv, i, triangle[i]);
    kernels::UvFace f;
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec4& p = position[triangle[i][static_cast<glm::length_t>(k)]];
      const auto corner = kernels::snap(p, corner_bits);
      if (!corner) return false;  // not rasterized
      f.px[k] = glm::dvec2(corner->x, corner->y) / double{kernels::corner_unit};
      f.per_w[k] = p.w;
      f.uv[k] = coordinates[rows[k]];
    }
    return !(kernels::greatest_uv_slope(f, map) <= texels);
  });
  return face < mesh.faces() ? std::optional(face) : std::nullopt;
}

}  // namespace frustum
