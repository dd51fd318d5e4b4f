// The points of surfaces that rays are sent on from.
#pragma once

#include "nodes/kernels/surface_point.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/rays.h"
#include "runtime/buffers/shading_scene.h"

#include <array>
#include <optional>
#include <span>

namespace frustum {

// What is read of the points of trace.points or rasterize.attributes: id and P, and where they are there N and the changes per
// pixel of both.
class SurfaceReader {
 public:
  // Throws NodeError("missing_plane") and NodeError("missing_column"). `stored` is the precision in which rays will be kept.
  SurfaceReader(const Tiled<Image>& points, const Ref<Mesh>& mesh, Precision stored);

  static constexpr std::size_t numbers = 18;
  static std::size_t scratch(std::size_t width) { return numbers * width; }

  struct Rows {
    const SurfaceReader* reader;
    const std::uint32_t* id;
    std::array<const double*, numbers> number{};
    // Put back on the plane of its face. Nothing where nothing is seen. Throws NodeError("wrong_mesh").
    std::optional<kernels::SurfacePoint> point(std::size_t x) const;
  };
  Rows rows(const Tile& points, int sample, int y, std::span<double> scratch) const;

 private:
  Ref<Mesh> mesh_;
  Ref<Column> world_;
  double roundoff_;
  int id_;
  std::array<RealPlane, numbers> planes_{};
};

}  // namespace frustum
