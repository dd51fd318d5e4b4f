// Faces of the screen in double, and which of them rays from any eye meet, in rationals.
#pragma once

#include "nodes/kernels/screen_triangle.h"
#include "tests/hard/exact.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace frustum::hard {

using glm::dvec2, glm::dvec3, glm::dvec4;

// Triangles on the screen in double: (x_px, y_px, depth, 1/w) a vertex.
struct DoubleTriangles {
  std::vector<dvec4> position;
  std::vector<glm::uvec3> face;

  void add(const dvec3& a, const dvec3& b, const dvec3& c) {
    const auto first = static_cast<std::uint32_t>(position.size());
    for (const dvec3& p : {a, b, c}) position.emplace_back(p, 1);
    face.push_back({first, first + 1, first + 2});
  }
  kernels::ScreenMesh<double> mesh() const { return {position, face, {}}; }
};

inline double on_grid(double px) { return std::floor(px * 256) / 256; }

using Place = std::array<Rational, 3>;  // x_px, y_px, depth

inline Place operator-(const Place& a, const Place& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Rational dot(const Place& a, const Place& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Place place(const dvec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

struct ExactFace {
  std::array<Place, 3> p;
  Place normal;

  explicit ExactFace(const std::array<dvec3, 3>& corner)
      : p{place(corner[0]), place(corner[1]), place(corner[2])} {
    const Place a = p[1] - p[0], b = p[2] - p[0];
    normal = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  // Twice the area, in px, that side k and q span, of the same sign as the face's inside of it.
  int side(std::size_t k, const Rational& x, const Rational& y) const {
    const Place &a = p[k], &b = p[(k + 1) % 3];
    return sgn(Rational((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]))) * sgn(normal[2]);
  }
};

struct Hit {
  std::uint32_t face;
  double t;  // how far along the ray
  dvec2 at;  // px
};

// Every face that the ray from `eye` along `way` meets in front of it, nearest first. Nothing where the answer hangs
// on less than 2^-14: a hit on a side of a face, or two hits next to each other.
inline std::optional<std::vector<Hit>> hits_of(const std::vector<ExactFace>& faces, const dvec3& eye,
                                               const dvec3& way) {
  const Place from = place(eye), along = place(way);
  std::vector<Hit> hits;
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const Rational slope = dot(faces[f].normal, along);
    if (sgn(slope) == 0) continue;
    const Rational t = dot(faces[f].normal, faces[f].p[0] - from) / slope;
    if (t <= 0) continue;
    const Rational x = from[0] + t * along[0], y = from[1] + t * along[1];
    int inside = 1;
    for (std::size_t k = 0; k < 3; ++k) inside = std::min(inside, faces[f].side(k, x, y));
    if (inside == 0) return std::nullopt;
    if (inside > 0) hits.push_back({f, t.get_d(), {x.get_d(), y.get_d()}});
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
  if (!hits.empty() && hits[0].t < 0x1p-14) return std::nullopt;
  for (std::size_t i = 1; i < hits.size(); ++i)
    if (hits[i].t - hits[i - 1].t < 0x1p-14) return std::nullopt;
  return hits;
}

}  // namespace frustum::hard
