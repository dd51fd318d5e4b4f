// Unit normals for mesh files that lack them.
#pragma once

#include "runtime/buffers/column.h"
#include "runtime/core/context.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace frustum {

// The unit vector along n; nothing where it has no finite length. Scaled first, so that no square overflows
// or underflows.
inline std::optional<glm::dvec3> unit(glm::dvec3 n) {
  const double size = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  if (!(size > 0) || !std::isfinite(size) || std::isnan(n.x) || std::isnan(n.y) || std::isnan(n.z)) return {};
  n /= size;
  return n / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
}

// (b - a) x (c - a): twice the area, along the normal.
template <class Vec3>
glm::dvec3 area_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
  const glm::dvec3 o(a), u = glm::dvec3(b) - o, w = glm::dvec3(c) - o;
  return {u.y * w.z - u.z * w.y, u.z * w.x - u.x * w.z, u.x * w.y - u.y * w.x};
}

// Adds the area normal of triangles [0, count) to their corners' sums, in order: the same bits every time.
// corner(t, k) is an index into positions and sums.
template <class Vec3, class Corner>
void add_area_normals(std::size_t count, Corner&& corner, std::span<const Vec3> positions,
                      std::span<glm::dvec3> sums, const Context& ctx) {
  for (std::size_t t = 0; t < count; ++t) {
    if (t % 65536 == 0) ctx.poll();
    const std::size_t v[3] = {corner(t, 0), corner(t, 1), corner(t, 2)};
    const glm::dvec3 n = area_normal(positions[v[0]], positions[v[1]], positions[v[2]]);
    for (const std::size_t i : v) sums[i] += n;
  }
}

// Makes every normal of a vertex column unit length. Those that have none become the sum of the area normals
// of the faces around, or 0 0 1 where that has no length either; returns how many. Cost: 20 ns a triangle
// where there are any, in one thread.
template <class R>
std::uint64_t finish_vertex_normals(Column& normals, std::span<const glm::uvec3> triangles,
                                    std::span<const glm::vec<3, R>> positions, const Context& ctx);

}  // namespace frustum
