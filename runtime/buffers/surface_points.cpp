#include "runtime/buffers/surface_points.h"

#include "nodes/kernels/seen_face.h"

#include <fmt/format.h>

#include <string>

namespace frustum {

SurfaceReader::SurfaceReader(const Tiled<Image>& points, const Ref<Mesh>& mesh, Precision stored)
    : mesh_(mesh), world_(world_positions<double>(*mesh)), roundoff_(0x1p-53), id_(points.read("id")) {
  const auto read = [&](std::size_t at, const std::string& name, bool needed) {
    if (needed || points.frame().find(name)) planes_[at] = read_real(points, name, Precision::real_double);
  };
  std::size_t at = 0;
  for (const std::string of : {"P", "N"}) {
    for (const char* component : {".x", ".y", ".z"}) read(at++, of + component, of == "P");
    for (const char* by : {"_dx", "_dy"})
      for (const char* component : {".dx", ".dy", ".dz"}) read(at++, of + component + by, false);
  }
  if (planes_[0].kind == PlaneKind::f32 || stored == Precision::single) roundoff_ = 0x1p-24;
}

SurfaceReader::Rows SurfaceReader::rows(const Tile& points, int sample, int y,
                                        std::span<double> scratch) const {
  const auto width = static_cast<std::size_t>(points.rect().width());
  Rows rows{this, points.row<const std::uint32_t>(id_, sample, y), {}};
  for (std::size_t i = 0; i < numbers; ++i)
    rows.number[i] = real_row<double>(points, planes_[i], sample, y, scratch.subspan(i * width, width));
  return rows;
}

std::optional<kernels::SurfacePoint> SurfaceReader::Rows::point(std::size_t x) const {
  if (id[x] == no_face) return std::nullopt;
  const auto faces = reader->mesh_->triangles();
  if (id[x] >= faces.size())
    throw NodeError("wrong_mesh",
                    fmt::format("face {} was met, but the mesh has {} faces: the points are of another mesh",
                                id[x], faces.size()),
                    at_input("mesh"));
  const auto world = reader->world_->values<glm::dvec3>();
  const glm::uvec3& f = faces[id[x]];
  const kernels::SeenFace face = kernels::seen_face(world[f.x], world[f.y], world[f.z], reader->roundoff_);
  const auto three = [&](std::size_t i) {
    if (number[i] == nullptr) return glm::dvec3(0);
    return glm::dvec3(number[i][x], number[i + 1][x], number[i + 2][x]);
  };
  return kernels::SurfacePoint{kernels::on_face(face, three(0)),
                               three(3),
                               three(6),
                               three(9),
                               three(12),
                               three(15),
                               face.normal,
                               face.slack};
}

}  // namespace frustum
