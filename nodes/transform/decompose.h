// An affine map as a product of the basic ones: translation, rotation, shear or a second rotation, scale.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <utility>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/matrix.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

namespace frustum::transform {

// M = translation rotation shear scale turn. Rotation and turn have determinant 1; a map that mirrors has its
// negative factor in scale.z.
struct Parts {
  glm::dvec3 translation{0};
  glm::dmat3 rotation{1.0};
  glm::dmat3 shear{1.0};  // upper triangular with ones on the diagonal
  glm::dvec3 scale{1};
  glm::dmat3 turn{1.0};
  bool mirrors() const { return scale.z < 0; }

  glm::dmat3 linear() const {
    glm::dmat3 s(0.0);
    for (glm::length_t i = 0; i < 3; ++i) s[i][i] = scale[i];
    return rotation * (shear * (s * turn));
  }
};

// max |a_rc| over entries.
inline double largest_entry(const glm::dmat3& a) {
  return std::max(
      {kernels::largest_component(a[0]), kernels::largest_component(a[1]), kernels::largest_component(a[2])});
}

namespace decompose_detail {

// a . b to twice the precision, rounded.
inline double dot(const glm::dvec3& a, const glm::dvec3& b) {
  auto sum = kernels::two_product(a.x, b.x);
  sum = kernels::plus(sum, kernels::two_product(a.y, b.y));
  return kernels::plus(sum, kernels::two_product(a.z, b.z)).hi;
}

// The factor along the third axis, with the sign that the map's determinant has: where the map is so flat that
// rounding hides it, some factor below u with that sign.
inline double signed_factor(double found, int side) {
  if (found * side > 0) return found;
  return side * (found == 0 ? 0x1p-60 : std::fabs(found));
}

}  // namespace decompose_detail

// By Gram and Schmidt, done twice, the third axis by the cross product: the axes are orthonormal to a few u however
// flat the map is. Requires a regular matrix of moderate size.
inline Parts by_shear(const glm::dmat3& a, int side) {
  using decompose_detail::dot;
  const glm::dvec3 x = kernels::normalized_or(a[0], {1, 0, 0});
  glm::dvec3 y = a[1] - x * dot(x, a[1]);
  y = kernels::normalized_or(y, {0, 1, 0});
  y = kernels::normalized_or(y - x * dot(x, y), {0, 1, 0});
  Parts p;
  p.rotation = glm::dmat3(x, y, kernels::cross(x, y));
  const glm::dvec3& z = p.rotation[2];
  p.scale = {dot(x, a[0]), dot(y, a[1]), decompose_detail::signed_factor(dot(z, a[2]), side)};
  p.shear[1][0] = dot(x, a[1]) / p.scale.y;
  p.shear[2][0] = dot(x, a[2]) / p.scale.z;
  p.shear[2][1] = dot(y, a[2]) / p.scale.z;
  return p;
}

// By one-sided Jacobi rotations until the columns are at right angles: a = rotation scale turn, scale falling.
// Small factors keep their digits. Source: Hestenes 1958; Demmel & Veselic 1992, SIAM J. Matrix Anal. 13:1204.
inline Parts by_turns(glm::dmat3 a, int side) {
  using decompose_detail::dot;
  glm::dmat3 v(1.0);
  constexpr int sweeps = 30;  // quadratic convergence: 3 to 6 are needed
  for (int sweep = 0, turned = 1; sweep < sweeps && turned > 0; ++sweep) {
    turned = 0;
    for (const auto& [i, k] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      const double p = dot(a[i], a[i]), q = dot(a[k], a[k]), both = dot(a[i], a[k]);
      if (!(std::fabs(both) > 0x1p-54 * std::sqrt(p) * std::sqrt(q))) continue;
      ++turned;
      const double zeta = (q - p) / (2 * both);
      const double t = (zeta < 0 ? -1 : 1) / (std::fabs(zeta) + std::sqrt(1 + zeta * zeta));
      const double c = 1 / std::sqrt(1 + t * t), s = c * t;
      for (glm::dmat3* m : {&a, &v}) {
        const glm::dvec3 left = (*m)[i], right = (*m)[k];
        (*m)[i] = left * c - right * s, (*m)[k] = left * s + right * c;
      }
    }
  }
  std::array<std::pair<double, int>, 3> order;
  for (int i = 0; i < 3; ++i) order[static_cast<std::size_t>(i)] = {-kernels::norm(a[i]), i};
  std::sort(order.begin(), order.end());
  Parts p;
  glm::dmat3 axes, turn;
  for (int i = 0; i < 3; ++i) {
    const auto [minus_length, column] = order[static_cast<std::size_t>(i)];
    p.scale[i] = -minus_length, axes[i] = a[column], turn[i] = v[column];
  }
  const glm::dvec3 x = kernels::normalized_or(axes[0], {1, 0, 0});
  const glm::dvec3 y = kernels::normalized_or(axes[1] - x * dot(x, axes[1]), {0, 1, 0});
  p.rotation = glm::dmat3(x, y, kernels::cross(x, y));
  turn = kernels::orthonormalized(turn);
  if (kernels::determinant_sign(turn[0], turn[1], turn[2]) < 0) turn[2] = -turn[2];
  p.scale.z = decompose_detail::signed_factor(p.scale.z * side, side);
  p.turn = glm::transpose(turn);
  return p;
}

enum class Split { shear, turns };

// The parts of a map, the linear one first brought to size 1 by an exact power of two. Nothing where the last row is
// not 0 0 0 1, a number is not finite, or the map has no inverse (decided exactly).
// Recomposed, no entry of the linear part is off by more than 16 u of its largest one.
inline std::optional<Parts> parts_of(const glm::dmat4& m, Split split) {
  const glm::dmat3 linear(m);
  const double largest = largest_entry(linear);
  if (m[0][3] != 0 || m[1][3] != 0 || m[2][3] != 0 || m[3][3] != 1) return std::nullopt;
  if (!std::isfinite(largest) || !std::isfinite(kernels::largest_component(m[3]))) return std::nullopt;
  const int side = kernels::determinant_sign(linear[0], linear[1], linear[2]);
  if (side == 0) return std::nullopt;
  const double size = kernels::power_of_two_towards_one(largest);
  Parts p = split == Split::shear ? by_shear(linear * size, side) : by_turns(linear * size, side);
  p.scale /= size;
  p.translation = glm::dvec3(m[3]);
  return p;
}

}  // namespace frustum::transform
