// The unit square of (u, v) on a convex quadrilateral of the screen, and back.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

// projective: straight lines stay straight; the picture of a plane under a camera. bilinear: lines of
// constant u and of constant v stay straight, and points that divide a side evenly stay even.
enum class QuadMapKind : std::uint8_t { projective, bilinear };

// Twice the signed area of a triangle, right to 2^-45 of itself unless its terms cancel to below 2^-50.
inline double area2(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
  const auto x = two_sum(b.x, -a.x), y = two_sum(b.y, -a.y), p = two_sum(c.x, -a.x), q = two_sum(c.y, -a.y);
  const auto right = product(y, p);
  return plus(product(x, q), {-right.hi, -right.lo}).hi;
}

// The change of (u, v) per pixel to the right and down.
struct UvSlopes {
  double du_dx, dv_dx, du_dy, dv_dy;
};

// With k_i twice the area of the triangle of the three corners other than i, the projective map is the
// rational bilinear one
//   x(u, v) = sum of b_i k_i p_i / sum of b_i k_i,   b = (1-u)(1-v), u(1-v), uv, (1-u)v,
// since k0 p0 - k1 p1 + k2 p2 - k3 p3 = 0; all weights are positive for a convex quadrilateral, so nothing
// cancels, and no system is solved. Its inverse is a ratio of distances to opposite sides, e_ij = twice the
// area of (p_i, p_j, x):
//   u = A / (A + B),  A = k0 k3 e_30,  B = k1 k2 e_12;   v alike with  k0 k1 e_01  and  k2 k3 e_23.
// Source: Heckbert 1989, Fundamentals of Texture Mapping and Image Warping, 2.2.3 and 2.2.4 (the maps; his
// inverse is the adjugate, which cancels); the bilinear inverse is his quadratic, solved without
// cancellation.
class QuadMap {
 public:
  // Corners of (u, v) = (0, 0), (1, 0), (1, 1), (0, 1), of either winding, in pixels with y down. Nothing
  // where they are not strictly convex (exactly decided), as where the plane is seen edge-on.
  static std::optional<QuadMap> of(const std::array<glm::dvec2, 4>& corner, QuadMapKind kind) {
    const int turn = orientation(corner[0], corner[1], corner[2]);
    for (std::size_t i = 0; i < 4; ++i)
      if (turn == 0 || orientation(corner[i], corner[(i + 1) % 4], corner[(i + 2) % 4]) != turn)
        return std::nullopt;
    return QuadMap(corner, kind, turn);
  }

  glm::dvec2 pixel_of(const glm::dvec2& uv) const {
    const double u = uv.x, v = uv.y;
    const std::array<double, 4> b{(1 - u) * (1 - v) * k_[0], u * (1 - v) * k_[1], u * v * k_[2],
                                  (1 - u) * v * k_[3]};
    const double sum = (b[0] + b[2]) + (b[1] + b[3]);
    glm::dvec2 at(0.0);
    for (std::size_t i = 0; i < 4; ++i) at += (p_[i] - p_[0]) * (b[i] / sum);
    return p_[0] + at;
  }

  glm::dvec2 uv_of(const glm::dvec2& px) const { return projective_ ? projective(px) : bilinear(px); }

  // At a point whose (u, v) is known.
  UvSlopes slopes(const glm::dvec2& px, const glm::dvec2& uv) const {
    if (projective_) {
      const auto [du_dx, du_dy] = slope(pair_u(px), 3, 0, 1, 2, k_[0] * k_[3], k_[1] * k_[2]);
      const auto [dv_dx, dv_dy] = slope(pair_v(px), 0, 1, 2, 3, k_[0] * k_[1], k_[2] * k_[3]);
      return {du_dx, dv_dx, du_dy, dv_dy};
    }
    const glm::dvec2 g = (p_[0] - p_[1]) + (p_[2] - p_[3]);
    const glm::dvec2 along_u = (p_[1] - p_[0]) + g * uv.y, along_v = (p_[3] - p_[0]) + g * uv.x;
    const double det = difference_of_products(along_u.x, along_v.y, along_u.y, along_v.x);
    return {along_v.y / det, -along_u.y / det, -along_v.x / det, along_u.x / det};
  }

  // Whether a point belongs to it: inside, or on a left side or on a top side that is level; exact.
  // Quadrilaterals that share a side share no point.
  bool contains(const glm::dvec2& px) const {
    for (std::size_t i = 0; i < 4; ++i) {
      const glm::dvec2 &a = p_[turn_ > 0 ? i : (i + 1) % 4], &b = p_[turn_ > 0 ? (i + 1) % 4 : i];
      const int side = orientation(a, b, px);
      const bool own = b.y < a.y || (b.y == a.y && b.x > a.x);
      if (side < 0 || (side == 0 && !own)) return false;
    }
    return true;
  }

  // The least of the four triangles' areas over the greatest: 1 for a parallelogram, 0 for three corners on a
  // line.
  double evenness() const {
    return *std::min_element(areas_.begin(), areas_.end()) / *std::max_element(areas_.begin(), areas_.end());
  }
  const std::array<glm::dvec2, 4>& corners() const { return p_; }

 private:
  QuadMap(const std::array<glm::dvec2, 4>& corner, QuadMapKind kind, int turn)
      : p_(corner), projective_(kind == QuadMapKind::projective), turn_(turn) {
    for (std::size_t i = 0; i < 4; ++i)
      areas_[i] = std::fabs(area2(p_[(i + 1) % 4], p_[(i + 2) % 4], p_[(i + 3) % 4]));
    const double largest = *std::max_element(areas_.begin(), areas_.end());
    for (std::size_t i = 0; i < 4; ++i) k_[i] = projective_ ? areas_[i] / largest : 1;
  }

  // Twice the area of (p_i, p_j, px), positive inside.
  double distance(std::size_t i, std::size_t j, const glm::dvec2& px) const {
    const glm::dvec2 side = p_[j] - p_[i], to = px - p_[i];
    return turn_ * difference_of_products(side.x, to.y, side.y, to.x);
  }
  std::array<double, 2> pair_u(const glm::dvec2& px) const {
    return {k_[0] * k_[3] * distance(3, 0, px), k_[1] * k_[2] * distance(1, 2, px)};
  }
  std::array<double, 2> pair_v(const glm::dvec2& px) const {
    return {k_[0] * k_[1] * distance(0, 1, px), k_[2] * k_[3] * distance(2, 3, px)};
  }
  glm::dvec2 projective(const glm::dvec2& px) const {
    const auto [a, b] = pair_u(px);
    const auto [c, d] = pair_v(px);
    return {a / (a + b), c / (c + d)};
  }

  // The slopes by x and y of a / (a + b), of which a has the factor ka and the side i-j, b kb and m-n.
  std::array<double, 2> slope(const std::array<double, 2>& ab, std::size_t i, std::size_t j, std::size_t m,
                              std::size_t n, double ka, double kb) const {
    const auto [a, b] = ab;
    const glm::dvec2 one = (p_[j] - p_[i]) * (ka * turn_), two = (p_[n] - p_[m]) * (kb * turn_);
    const double whole = (a + b) * (a + b);
    return {(b * -one.y - a * -two.y) / whole, (b * one.x - a * two.x) / whole};
  }

  // (h - v f) x (e + v g) = 0; of its two roots the one where the map does not turn over.
  glm::dvec2 bilinear(const glm::dvec2& px) const {
    const glm::dvec2 e = p_[1] - p_[0], f = p_[3] - p_[0], g = (p_[0] - p_[1]) + (p_[2] - p_[3]),
                     h = px - p_[0];
    const auto cross = [&](const glm::dvec2& p, const glm::dvec2& q) {
      return turn_ * difference_of_products(p.x, q.y, p.y, q.x);
    };
    const double a = cross(g, f), b = cross(h, g) + cross(e, f), c = cross(h, e);
    const double root = std::sqrt(std::max(0.0, difference_of_products(b, b, 4 * a, c)));
    const double v = b >= 0 ? -2 * c / (b + root) : (root - b) / (2 * a);
    const glm::dvec2 along = e + g * v;
    return {dot(h - f * v, along) / dot(along, along), v};
  }

  std::array<glm::dvec2, 4> p_;
  std::array<double, 4> areas_{}, k_{};
  bool projective_;
  int turn_;
};

}  // namespace frustum::kernels
