// Visible points one after another, each with the face it lies on: what the nodes that find shadows walk over.
#pragma once

#include "nodes/kernels/seen_face.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/real_rows.h"
#include "runtime/buffers/shading_scene.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum {

struct SeenPoints {
  Ref<Mesh> mesh;
  Ref<Column> world;  // positions of its vertices, f64
  int id = -1;
  std::array<RealPlane, 3> position{};

  double roundoff() const { return position[0].kind == PlaneKind::f32 ? 0x1p-24 : 0x1p-53; }
};

// Names the planes that tile() will read, whatever their precision. Throws NodeError("missing_plane") and
// NodeError("missing_column").
inline SeenPoints read_points(const Tiled<Image>& points, const Ref<Mesh>& mesh) {
  SeenPoints s{mesh, world_positions<double>(*mesh), points.read("id"), {}};
  for (std::size_t k = 0; k < 3; ++k)
    s.position[k] = read_real(points, std::array{"P.x", "P.y", "P.z"}[k], Precision::real_double);
  return s;
}

// Fills the planes of `to` with share(plane, face, p, hint), p on the plane of its face in world space; 0 where nothing is
// seen. `hint` is a number of the plane's that lives from point to point of a row, 0 at first.
//   points  the same rectangle
template <class R, class Share>
void fill_shares(const SeenPoints& s, const Tile& points, const Tile& to, Arena& arena, const Share& share) {
  const auto n = static_cast<std::size_t>(to.rect().width());
  const auto world = s.world->values<glm::dvec3>();
  const auto triangles = s.mesh->triangles();
  std::array<std::span<double>, 3> scratch;
  for (auto& row : scratch) row = arena.take<double>(n);
  const std::size_t planes = to.frame().planes.size();
  std::vector<R*> out(planes);
  std::vector<std::uint32_t> hint(planes);
  const auto fill_row = [&](const std::uint32_t* id, const std::array<const double*, 3>& position) {
    std::uint32_t current = no_face;
    kernels::SeenFace face{};
    for (std::size_t x = 0; x < n; ++x) {
      const std::uint32_t f = id[x];
      const bool seen = f < triangles.size();
      if (seen && f != current) {
        const glm::uvec3& t = triangles[f];
        current = f, face = kernels::seen_face(world[t.x], world[t.y], world[t.z], s.roundoff());
      }
      const glm::dvec3 p = kernels::on_face(face, {position[0][x], position[1][x], position[2][x]});
      for (std::size_t i = 0; i < planes; ++i)
        if (out[i] != nullptr) out[i][x] = seen ? static_cast<R>(share(i, face, p, hint[i])) : R(0);
    }
  };
  for (int k = 0; k < to.samples(); ++k)
    for (int y = to.rect().y0; y < to.rect().y1; ++y) {
      std::array<const double*, 3> position{};
      for (std::size_t i = 0; i < 3; ++i)
        position[i] = real_row<double>(points, s.position[i], k, y, scratch[i]);
      for (std::size_t i = 0; i < planes; ++i) out[i] = out_row<R>(to, static_cast<int>(i), k, y);
      std::fill(hint.begin(), hint.end(), 0U);
      fill_row(points.row<const std::uint32_t>(s.id, k, y), position);
    }
}

// The same in the precision of the planes.
template <class Share>
void fill_shares(const SeenPoints& s, const Tile& points, const Tile& to, Arena& arena, const Share& share) {
  if (to.frame().planes.empty()) return;
  const Tile part = points.part(to.rect());
  if (to.frame().planes[0].kind == PlaneKind::f32)
    fill_shares<float>(s, part, to, arena, share);
  else
    fill_shares<double>(s, part, to, arena, share);
}

}  // namespace frustum
