// The signs of many small determinants at once, as far as float can tell them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

namespace frustum::kernels::simd {

// Where the rows of the determinants lie: vertex v has x and y at position[stride v] and [stride v + 1], and
// its third number at [stride v + third], or 1 where `third` is negative.
struct RowLayout {
  const float* position;
  std::size_t vertices, stride;
  int third;
};

inline constexpr std::int8_t unclear_sign = 2;

// sign[f] = 1 or -1 where rounding cannot have changed the sign of det[a; b; c] of triangle f, and
// unclear_sign elsewhere, NaN and infinities included. Scalar twin, and what to ask where it is unclear:
// kernels::determinant_sign, whose exact sign makes the answer of both together independent of the target.
// Requires equal sizes.
//
// The determinant is taken as a . ((b - a) x (c - a)), so that the bound shrinks with the triangle: on a
// mesh of a million faces all but those within 1e-5 rad of edge-on are clear.
void clear_signs(const RowLayout& rows, std::span<const glm::uvec3> triangle, std::span<std::int8_t> sign);

}  // namespace frustum::kernels::simd
