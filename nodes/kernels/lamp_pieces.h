// A flat lamp as points that stand for equal pieces of it.
#pragma once

#include "nodes/kernels/sample_pattern.h"
#include "nodes/kernels/vector.h"

#include <cstdint>
#include <glm/vec3.hpp>

namespace frustum::kernels {

// A rectangle (or parallelogram) around `centre` that shines to where edge_u x edge_v points. Its n points are the first
// of Sobol's (0,2)-sequence, moved by half a stratum: for n = 2^k each dyadic part of area 2^-k holds exactly one,
// and the n points of one lamp are not those of 2 n, so that what they err in does not add up over a sweep.
// The same points for every pixel: shadows of a lamp are n sharp ones, without noise.
class LampPieces {
 public:
  LampPieces(const glm::dvec3& centre, const glm::dvec3& edge_u, const glm::dvec3& edge_v, std::uint32_t n)
      : centre_(centre), u_(edge_u), v_(edge_v), half_(0.5 / n) {}

  double area() const { return norm(cross(u_, v_)); }
  // Unit; 0 for a lamp without area.
  glm::dvec3 axis() const { return normalized_or(cross(u_, v_), glm::dvec3(0)); }
  glm::dvec3 point(std::uint32_t i) const {
    const auto [a, b] = pattern_detail::sobol(i);
    const auto centred = [&](std::uint32_t x) { return static_cast<double>(x) * 0x1p-32 + half_ - 0.5; };
    return centre_ + u_ * centred(a) + v_ * centred(b);
  }

 private:
  glm::dvec3 centre_, u_, v_;
  double half_;
};

}  // namespace frustum::kernels
