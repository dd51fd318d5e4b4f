// Projections onto the plane z = -N, as the course first draws them: maps of rank 3 that flatten space.
#pragma once

#include <cmath>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>

namespace frustum::project {

enum class Planar { orthographic, perspective };

// (x, y, z) -> (x, y, -N), or by the eye at the origin -> (-N x / z, -N y / z, -N). Nothing for a point that the
// perspective cannot see: in the eye's plane, or so near to it that the
// picture is out of range, or behind it (errata E9). Projecting twice changes no bit: the second
// time -N / z is 1. Error of x and y: 2 roundings.
inline std::optional<glm::dvec3> projected(const glm::dvec3& p, Planar kind, double n) {
  if (kind == Planar::orthographic) return glm::dvec3(p.x, p.y, -n);
  if (!(p.z < 0)) return std::nullopt;
  const double shrink = n / -p.z;
  const glm::dvec3 q(p.x * shrink, p.y * shrink, -n);
  if (!std::isfinite(q.x) || !std::isfinite(q.y)) return std::nullopt;
  return q;
}

// The same as a matrix: the perspective's last row makes w = -z / N, by which to divide. Both of rank 3: neither has
// an inverse, and depth is gone, so that no z-buffer can follow (errata E9).
inline glm::dmat4 planar_matrix(Planar kind, double n) {
  glm::dmat4 m(1.0);
  if (kind == Planar::orthographic)
    m[2][2] = 0, m[3][2] = -n;
  else
    m[3][3] = 0, m[2][3] = -1 / n;
  return m;
}

}  // namespace frustum::project
