#include "runtime/io/triangulate.h"

#include "nodes/kernels/triangulate_polygon.h"
#include "nodes/kernels/vector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

// The polygon without the axis along which it is thinnest, turned so that it is counter-clockwise, and scaled
// by a power of two to about 1, where no product over- or underflows.
std::vector<glm::dvec2> seen_from_the_front(std::span<const glm::dvec3> p) {
  glm::dvec3 size{0}, normal{0};
  for (const glm::dvec3& q : p) size = glm::max(size, glm::abs(q));
  const double scale = kernels::power_of_two_towards_one(std::max({size.x, size.y, size.z}));
  const glm::dvec3 first = scale * p[0];
  for (std::size_t i = 1; i + 1 < p.size(); ++i)
    normal += glm::cross(scale * p[i] - first, scale * p[i + 1] - first);
  const glm::dvec3 area = glm::abs(normal);
  const int drop = area.x >= area.y && area.x >= area.z ? 0 : area.y >= area.z ? 1 : 2;
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (normal[drop] < 0) std::swap(u, v);
  std::vector<glm::dvec2> out;
  out.reserve(p.size());
  for (const glm::dvec3& q : p) out.emplace_back(scale * q[u], scale * q[v]);
  return out;
}

}  // namespace

bool triangulate(std::span<const glm::dvec3> corners, std::vector<std::array<std::uint32_t, 3>>& out) {
  return kernels::triangulate_polygon(seen_from_the_front(corners), out);
}

}  // namespace frustum
