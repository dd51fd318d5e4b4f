#include "runtime/io/ply_faces.h"

#include "runtime/io/ply_body.h"
#include "runtime/io/triangulate.h"

#include <algorithm>

namespace frustum::ply {

template <class R>
void cut_faces(const Lists<R>& lists, std::uint64_t first, std::span<const glm::vec<3, R>> positions,
               CutParts parts, Cut& out) {
  out.triangles.reserve(lists.indices.size() / 3);
  std::vector<glm::dvec3> polygon;
  std::vector<std::array<std::uint32_t, 3>> cut;
  std::uint32_t at = 0;
  for (std::size_t f = 0; f < lists.sizes.size(); at += lists.sizes[f++]) {
    const std::uint32_t n = lists.sizes[f];
    const std::uint32_t* index = lists.indices.data() + at;
    cut.clear();
    if (n == 3) {
      cut.push_back({0, 1, 2});
    } else if (n > 3) {
      polygon.clear();
      for (std::uint32_t k = 0; k < n; ++k) polygon.emplace_back(positions[index[k]]);
      if (!triangulate(polygon, cut)) ++out.fans;
    } else {
      ++out.skipped;
    }
    for (const auto& [a, b, c] : cut) {
      out.triangles.emplace_back(index[a], index[b], index[c]);
      if (parts.corners) out.corners.emplace_back(at + a, at + b, at + c);
      if (parts.faces) out.faces.push_back(static_cast<std::uint32_t>(first + f));
    }
  }
}
template void cut_faces(const Lists<float>&, std::uint64_t, std::span<const glm::vec3>, CutParts, Cut&);
template void cut_faces(const Lists<double>&, std::uint64_t, std::span<const glm::dvec3>, CutParts, Cut&);

void cut_strips(std::span<const std::uint32_t> sizes, std::span<const std::uint32_t> indices, Cut& out) {
  const std::uint32_t* at = indices.data();
  for (const std::uint32_t n : sizes) {
    std::uint32_t begin = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (at[i] == ~std::uint32_t{0}) begin = i + 1;
      if (i < begin + 2) continue;
      const glm::uvec3 t{at[i - 2], at[i - 1], at[i]};
      if (t.x == t.y || t.y == t.z || t.x == t.z) continue;
      out.triangles.push_back((i - begin) % 2 == 0 ? t : glm::uvec3(t.y, t.x, t.z));
    }
    at += n;
  }
}

template <class R>
std::shared_ptr<Column> gather_corner_uv(std::span<const Cut> cuts, std::span<const std::size_t> first,
                                         std::span<const Lists<R>> lists, std::size_t triangles) {
  using Vec2 = glm::vec<2, R>;
  auto column = Column::make<Vec2>("uv", Domain::corner, 3 * triangles);
  const auto out = column->template values<Vec2>();
  std::fill(out.begin(), out.end(), Vec2{0});
  for (std::size_t i = 0; i < cuts.size(); ++i) {
    const R* uv = lists[i].corner_uv.data();
    for (std::size_t t = 0; t < cuts[i].corners.size(); ++t)
      for (glm::length_t k = 0; k < 3; ++k) {
        const std::size_t from = 2 * std::size_t{cuts[i].corners[t][k]};
        out[3 * (first[i] + t) + static_cast<std::size_t>(k)] = {uv[from], uv[from + 1]};
      }
  }
  return column;
}
template std::shared_ptr<Column> gather_corner_uv(std::span<const Cut>, std::span<const std::size_t>,
                                                  std::span<const Lists<float>>, std::size_t);
template std::shared_ptr<Column> gather_corner_uv(std::span<const Cut>, std::span<const std::size_t>,
                                                  std::span<const Lists<double>>, std::size_t);

Ref<Column> gather_face_column(const Column& from, std::span<const Cut> cuts,
                               std::span<const std::size_t> first, std::size_t triangles) {
  auto column = std::make_shared<Column>(from.name(), Domain::face, from.kind(), from.width(), triangles);
  const std::size_t size = bytes_of(from.kind()) * static_cast<std::size_t>(from.width());
  auto* to = static_cast<std::byte*>(column->data());
  std::fill_n(to, column->bytes(), std::byte{0});
  for (std::size_t i = 0; i < cuts.size(); ++i)
    for (std::size_t t = 0; t < cuts[i].faces.size(); ++t)
      std::copy_n(static_cast<const std::byte*>(from.data()) + size * cuts[i].faces[t], size,
                  to + size * (first[i] + t));
  return column;
}

}  // namespace frustum::ply
