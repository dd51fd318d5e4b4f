// Rays as pixels: ways along which light is followed, one a sample.
//   O.x O.y O.z       where it starts
//   D.x D.y D.z       whither, of any length; all 0: there is no ray
//   slack             how far O may lie off the surface that it starts on; what is nearer than that is not met
//   O.dx_dx O.dy_dx O.dz_dx  O.dx_dy ...  D.dx_dx ...   their change per pixel, by x and by y
#pragma once

#include "nodes/kernels/ray_beam.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/real_rows.h"

#include <array>
#include <span>

namespace frustum {

constexpr std::size_t ray_numbers = 19;

// Their planes in this order.
PlaneList ray_planes(PlaneKind kind);

// A reader of rays. Throws NodeError("missing_plane") for pixels that are none.
class RayReader {
 public:
  RayReader() = default;
  // With `slopes` also how they change from pixel to pixel. Names the planes that tile() will read.
  RayReader(const Tiled<Image>& rays, bool slopes);

  // Numbers of scratch memory for rows of `width`.
  static std::size_t scratch(std::size_t width) { return ray_numbers * width; }

  // The rows of one sample at y; `scratch` lives as long.
  struct Rows {
    std::array<const double*, ray_numbers> number{};
    kernels::RayBeam beam(std::size_t x) const;
    double slack(std::size_t x) const { return number[6][x]; }
  };
  Rows rows(const Tile& rays, int sample, int y, std::span<double> scratch) const;

 private:
  std::array<RealPlane, ray_numbers> planes_{};
};

// Writes rays into a row of a tile whose frame has ray_planes(), in the precision R; planes that nobody reads are left.
template <class R>
class RayWriter {
 public:
  RayWriter() = default;  // nobody reads them
  RayWriter(const Tile& to, int sample, int y) {
    for (std::size_t i = 0; i < ray_numbers; ++i) row_[i] = out_row<R>(to, static_cast<int>(i), sample, y);
  }
  void put(std::size_t x, const kernels::RayBeam& beam, double slack) const {
    three(0, x, beam.origin), three(3, x, beam.along);
    if (row_[6] != nullptr) row_[6][x] = static_cast<R>(slack);
    three(7, x, beam.origin_dx), three(10, x, beam.origin_dy);
    three(13, x, beam.along_dx), three(16, x, beam.along_dy);
  }
  void put_none(std::size_t x) const { put(x, {}, 0); }

 private:
  void three(std::size_t first, std::size_t x, const glm::dvec3& v) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (row_[first + k] != nullptr) row_[first + k][x] = static_cast<R>(v[static_cast<glm::length_t>(k)]);
  }
  std::array<R*, ray_numbers> row_{};
};

}  // namespace frustum
