#include "runtime/io/triangulate.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <cmath>
#include <numeric>

namespace frustum {
namespace {

using Point = glm::dvec2;

// Twice the signed area of abc; positive where it turns left.
double turn(Point a, Point b, Point c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

// The polygon without the axis along which it is thinnest, turned so that it is counter-clockwise.
std::vector<Point> project(std::span<const glm::dvec3> p) {
  glm::dvec3 n{0};
  for (std::size_t i = 0; i < p.size(); ++i) n += glm::cross(p[i] - p[0], p[(i + 1) % p.size()] - p[0]);
  const glm::dvec3 size{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  const int drop = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  int u = (drop + 1) % 3, v = (drop + 2) % 3;
  if (n[drop] < 0) std::swap(u, v);
  std::vector<Point> out;
  for (const glm::dvec3& q : p) out.emplace_back(q[u], q[v]);
  return out;
}

bool is_fan(const std::vector<Point>& p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i)
    if (!(turn(p[0], p[i], p[i + 1]) > 0)) return false;
  return true;
}

// Whether the corner i of `ring` can be cut off: it turns left and no other corner lies in its triangle.
bool is_ear(const std::vector<Point>& p, const std::vector<std::uint32_t>& ring, std::size_t i) {
  const std::size_t n = ring.size();
  const Point a = p[ring[(i + n - 1) % n]], b = p[ring[i]], c = p[ring[(i + 1) % n]];
  if (!(turn(a, b, c) > 0)) return false;
  for (const std::uint32_t k : ring) {
    const Point q = p[k];
    if (q == a || q == b || q == c) continue;
    if (turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0) return false;
  }
  return true;
}

}  // namespace

bool triangulate(std::span<const glm::dvec3> corners, std::vector<std::array<std::uint32_t, 3>>& out) {
  std::vector<std::uint32_t> ring(corners.size());
  std::iota(ring.begin(), ring.end(), 0u);
  bool exact = true;
  if (corners.size() > 3) {
    const std::vector<Point> p = project(corners);
    exact = is_fan(p);
    if (!exact && corners.size() <= 4096) {
      exact = true;
      for (std::size_t i = 0, failed = 0; ring.size() > 3 && failed < ring.size();) {
        i %= ring.size();
        if (!is_ear(p, ring, i)) {
          ++i, ++failed;
          continue;
        }
        const std::size_t n = ring.size();
        out.push_back({ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(i));
        failed = 0;
      }
      exact = ring.size() == 3;
    }
  }
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) out.push_back({ring[0], ring[i], ring[i + 1]});
  return exact;
}

}  // namespace frustum
