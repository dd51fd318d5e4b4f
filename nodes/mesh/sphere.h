// A sphere of circles of latitude.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/parallel.h"

namespace frustum::mesh {

// `segments` meridians from pole to pole and rings - 1 circles between the poles. u runs eastwards from the
// meridian through +z, v from the south pole (-y) to the north pole. Each pole is one vertex: 0 is south, the
// last one north; the j-th circle from the south, 0 < j < rings, begins at 1 + (j - 1) segments. The seam
// u = 0 = 1 shares its vertices, so uv belongs to corners; a corner at a pole has the u of its triangle's
// middle, for the pole has none.
struct SphereShape {
  double radius;
  std::uint32_t segments, rings;  // >= 3, >= 2

  std::size_t vertices() const { return std::size_t{segments} * (rings - 1) + 2; }
  std::size_t faces() const { return 2 * std::size_t{segments} * (rings - 1); }
  std::uint32_t vertex(std::uint32_t i, std::uint32_t j) const {
    if (j == 0) return 0;
    const std::uint32_t first = 1 + (j - 1) * segments;
    return j == rings ? first : first + i % segments;
  }
};

// Unit normals and radius times them: each rounded once from double, whose sine and cosine are exact at
// quarter turns. Requires vertices() elements.
template <std::floating_point R>
void sphere_vertices(const SphereShape& s, std::span<glm::vec<3, R>> position,
                     std::span<glm::vec<3, R>> normal) {
  std::vector<kernels::SinCos<double>> around;
  for (std::uint32_t i = 0; i < s.segments; ++i)
    around.push_back(kernels::sin_cos_degrees(360.0 * i / s.segments));
  const auto place = [&](std::size_t k, const glm::dvec3& n) {
    normal[k] = glm::vec<3, R>(n);
    position[k] = glm::vec<3, R>(n * s.radius);
  };
  place(0, {0, -1, 0});
  place(s.vertices() - 1, {0, 1, 0});
  kernels::parallel_blocks(s.rings - 1, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j) {
      const auto latitude = kernels::sin_cos_degrees(180.0 * static_cast<double>(j + 1) / s.rings - 90);
      for (std::size_t i = 0; i < s.segments; ++i)
        place(1 + j * s.segments + i,
              {around[i].sin * latitude.cos, latitude.sin, around[i].cos * latitude.cos});
    }
  });
}

// The triangles of all bands from south to north, and (u, v) at their corners. Requires faces() and
// 3 faces() elements.
template <std::floating_point R>
void sphere_faces(const SphereShape& s, std::span<glm::uvec3> triangle, std::span<glm::vec<2, R>> uv) {
  struct Corner {
    std::uint32_t i, j;  // meridian and circle
    double column;       // u segments
  };
  const auto put = [&](std::size_t f, const std::array<Corner, 3>& corners) {
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& [i, j, column] = corners[c];
      triangle[f][static_cast<glm::length_t>(c)] = s.vertex(i, j);
      uv[3 * f + c] = glm::vec<2, R>(column / s.segments, static_cast<double>(j) / s.rings);
    }
  };
  kernels::parallel_blocks(s.rings, 16, [&](std::size_t begin, std::size_t end) {
    for (auto j = static_cast<std::uint32_t>(begin); j < end; ++j) {
      std::size_t f = j == 0 ? 0 : std::size_t{s.segments} * (2 * std::size_t{j} - 1);
      for (std::uint32_t i = 0; i < s.segments; ++i) {
        const Corner a{i, j, 1.0 * i}, b{i + 1, j, i + 1.0}, c{i + 1, j + 1, i + 1.0}, d{i, j + 1, 1.0 * i};
        const double middle = i + 0.5;
        if (j == 0) {
          put(f++, {Corner{i, j, middle}, c, d});
        } else if (j + 1 == s.rings) {
          put(f++, {a, b, Corner{i, j + 1, middle}});
        } else {
          put(f++, {a, b, c});
          put(f++, {a, c, d});
        }
      }
    }
  });
}

}  // namespace frustum::mesh
