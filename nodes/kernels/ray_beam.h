// A ray with its neighbours: how its start and its way change from pixel to pixel.
#pragma once

#include <array>
#include <glm/vec3.hpp>

#include "nodes/kernels/interpolate_attributes.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// The points origin + t along, t > 0, and the derivatives of both by x and y in pixels.
// Source: Igehy 1999, Tracing ray differentials, doi:10.1145/311535.311555.
struct RayBeam {
  glm::dvec3 origin{0}, along{0};
  glm::dvec3 origin_dx{0}, origin_dy{0}, along_dx{0}, along_dy{0};
};

// The weights of a triangle's corners where a beam meets it, and how they change from pixel to pixel.
//   u, v  of corners b and c, as TriangleTree::nearest gives them
// With s = origin - a, p = along x (c - a), q = s x (b - a) and D = p . (b - a) the weights are u = s . p / D and
// v = along . q / D; the derivatives are those of these quotients, with the values that are known. 0 where D is 0: the
// beam lies in the triangle's plane. `w` is left at 0.
inline SampleWeights weights_of_hit(const std::array<glm::dvec3, 3>& corner, const RayBeam& beam, double u,
                                    double v) {
  const glm::dvec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0], s = beam.origin - corner[0];
  const glm::dvec3 p = cross(beam.along, ac), q = cross(s, ab);
  const double d = dot(p, ab), inverse = d != 0 ? 1 / d : 0;
  const auto slopes = [&](const glm::dvec3& of_origin, const glm::dvec3& of_along) {
    const glm::dvec3 dp = cross(of_along, ac);
    const double dd = dot(dp, ab);
    const double du = ((dot(of_origin, p) + dot(s, dp)) - u * dd) * inverse,
                 dv = ((dot(of_along, q) + dot(beam.along, cross(of_origin, ab))) - v * dd) * inverse;
    return std::array{-(du + dv), du, dv};
  };
  const std::array m{(1 - u) - v, u, v}, m_dx = slopes(beam.origin_dx, beam.along_dx),
                                         m_dy = slopes(beam.origin_dy, beam.along_dy);
  const std::size_t b = m[0] >= m[1] && m[0] >= m[2] ? 0
                        : m[1] >= m[2]               ? 1
                                                     : 2,
                    i = (b + 1) % 3, j = (b + 2) % 3;
  return {static_cast<int>(b), m[i], m[j], m_dx[i], m_dx[j], m_dy[i], m_dy[j], 0};
}

}  // namespace frustum::kernels
