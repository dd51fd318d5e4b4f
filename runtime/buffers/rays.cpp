#include "runtime/buffers/rays.h"

#include <string>

namespace frustum {
namespace {

const std::array<std::string, ray_numbers>& names() {
  static const auto all = [] {
    std::array<std::string, ray_numbers> out{"O.x", "O.y", "O.z", "D.x", "D.y", "D.z", "slack"};
    std::size_t i = 7;
    for (const char* of : {"O", "D"})
      for (const char* by : {"_dx", "_dy"})
        for (const char* component : {".dx", ".dy", ".dz"}) out[i++] = std::string(of) + component + by;
    return out;
  }();
  return all;
}

}  // namespace

PlaneList ray_planes(PlaneKind kind) {
  PlaneList planes;
  for (const std::string& name : names()) planes.push_back({name, kind});
  return planes;
}

RayReader::RayReader(const Tiled<Image>& rays, bool slopes) {
  for (std::size_t i = 0; i < (slopes ? ray_numbers : 7); ++i)
    planes_[i] = read_real(rays, names()[i], Precision::real_double);
}

RayReader::Rows RayReader::rows(const Tile& rays, int sample, int y, std::span<double> scratch) const {
  const auto width = static_cast<std::size_t>(rays.rect().width());
  Rows rows;
  for (std::size_t i = 0; i < ray_numbers; ++i)
    rows.number[i] = real_row<double>(rays, planes_[i], sample, y, scratch.subspan(i * width, width));
  return rows;
}

kernels::RayBeam RayReader::Rows::beam(std::size_t x) const {
  const auto three = [&](std::size_t i) {
    if (number[i] == nullptr) return glm::dvec3(0);
    return glm::dvec3(number[i][x], number[i + 1][x], number[i + 2][x]);
  };
  return {three(0), three(3), three(7), three(10), three(13), three(16)};
}

}  // namespace frustum
