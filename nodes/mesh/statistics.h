// What a mesh is like: its topology and the shape of its triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <span>
#include <vector>

#include "nodes/kernels/join_points.h"
#include "nodes/kernels/mesh_edges.h"
#include "nodes/kernels/parallel.h"
#include "nodes/kernels/surface_measures.h"
#include "nodes/kernels/vertex_corners.h"

namespace frustum::mesh {

// Faces two of whose corners are one vertex have no edges and count in none of these.
struct Topology {
  std::size_t vertices = 0;      // that such a face uses
  std::size_t faces = 0;         // with three different corners
  std::size_t collapsed = 0;     // the others
  std::size_t duplicate = 0;     // with the same three corners as a face before, in any order
  std::size_t edges = 0;         // pairs of corners, whatever their faces
  std::size_t boundary = 0;      // edges of one face
  std::size_t non_manifold = 0;  // edges of three or more faces
  std::size_t misoriented = 0;   // edges that two faces run along in the same direction
  std::size_t components = 0;    // connected by shared vertices

  // Every edge has two faces of opposite direction.
  bool closed() const { return faces > 0 && boundary + non_manifold + misoriented == 0; }
  // Euler characteristic V - E + F: 2 a sphere, 0 a torus; the sum over components.
  std::int64_t euler() const {
    return static_cast<std::int64_t>(vertices) - static_cast<std::int64_t>(edges) +
           static_cast<std::int64_t>(faces);
  }
};

// `place` gives every vertex the number of the one it counts as. Requires indices within it. Cost: linear but
// for a sort among the edges of each vertex.
inline Topology topology_of(std::span<const glm::uvec3> triangle, std::span<const std::uint32_t> place) {
  Topology t;
  for (const kernels::MeshEdge& e : kernels::mesh_edges(triangle, place, [](const auto&) { return true; })) {
    ++t.edges;
    t.boundary += e.faces == 1 ? 1U : 0U;
    t.non_manifold += e.faces > 2 ? 1U : 0U;
    t.misoriented += e.faces == 2 && !e.turned ? 1U : 0U;
  }

  const std::size_t n = place.size();
  kernels::DisjointSets sets(n);
  std::vector<std::uint8_t> used(n, 0);
  kernels::FirstSeen seen(triangle.size());
  const auto sorted = [&](std::size_t f) {
    std::array<std::uint32_t, 3> v{place[triangle[f].x], place[triangle[f].y], place[triangle[f].z]};
    std::sort(v.begin(), v.end());
    return v;
  };
  for (std::uint32_t f = 0; f < triangle.size(); ++f) {
    const auto v = sorted(f);
    if (v[0] == v[1] || v[1] == v[2]) {
      ++t.collapsed;
      continue;
    }
    ++t.faces;
    for (const std::uint32_t k : v) used[k] = 1;
    sets.join(v[0], v[1]), sets.join(v[1], v[2]);
    const std::uint64_t hash = v[0] + kernels::stirred(v[1] + kernels::stirred(v[2]));
    if (seen.of(hash, f, [&](std::uint32_t g) { return sorted(g) == v; }) != f) ++t.duplicate;
  }
  for (std::uint32_t v = 0; v < n; ++v) {
    if (used[v] == 0) continue;
    ++t.vertices;
    t.components += sets.find(v) == v ? 1U : 0U;
  }
  return t;
}

// The shapes of the faces whose corners are finite.
struct Shapes {
  std::size_t without_area = 0;  // whose area rounds to 0
  std::size_t not_finite = 0;    // with a corner that is NaN or infinite, which are not measured
  double shortest_edge = 0, longest_edge = 0;
  double worst_aspect = 0;  // sqrt(3) L^2 / 4 A for the longest edge L and area A: 1 if equilateral
  double smallest_angle = 0, largest_angle = 0;  // radians, of faces with an area
};

template <std::floating_point R>
Shapes shapes_of(const kernels::Triangles<R>& mesh) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  const std::size_t n = mesh.triangle.size();
  std::vector<Shapes> blocks((n + kernels::usual_block - 1) / kernels::usual_block,
                             Shapes{0, 0, inf, 0, 0, inf, 0});
  kernels::parallel_blocks(n, kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    Shapes& s = blocks[begin / kernels::usual_block];
    for (std::size_t f = begin; f < end; ++f) {
      if (!mesh.finite(f)) {
        ++s.not_finite;
        continue;
      }
      const auto p = mesh.corners(f);
      const std::array edges{p[1] - p[0], p[2] - p[1], p[0] - p[2]};
      double longest = 0;
      for (const auto& e : edges) {
        const double length = kernels::norm(e);
        longest = std::max(longest, length);
        s.shortest_edge = std::min(s.shortest_edge, length);
      }
      s.longest_edge = std::max(s.longest_edge, longest);
      const double scale = longest > 0 ? kernels::power_of_two_towards_one(longest) : 1;
      const double twice_area = kernels::norm(kernels::cross(edges[0] * scale, edges[1] * scale));
      if (!(twice_area > 0)) {
        ++s.without_area;
        continue;
      }
      const double l = longest * scale;
      s.worst_aspect = std::max(s.worst_aspect, std::sqrt(3.0) / 2 * (l * l / twice_area));
      for (std::size_t c = 0; c < 3; ++c) {
        const double angle = kernels::angle_between(edges[c], -edges[(c + 2) % 3]);
        s.smallest_angle = std::min(s.smallest_angle, angle);
        s.largest_angle = std::max(s.largest_angle, angle);
      }
    }
  });
  Shapes all{0, 0, inf, 0, 0, inf, 0};
  for (const Shapes& s : blocks) {
    all.without_area += s.without_area, all.not_finite += s.not_finite;
    all.shortest_edge = std::min(all.shortest_edge, s.shortest_edge);
    all.longest_edge = std::max(all.longest_edge, s.longest_edge);
    all.worst_aspect = std::max(all.worst_aspect, s.worst_aspect);
    all.smallest_angle = std::min(all.smallest_angle, s.smallest_angle);
    all.largest_angle = std::max(all.largest_angle, s.largest_angle);
  }
  if (all.shortest_edge == inf) all.shortest_edge = 0;
  if (all.smallest_angle == inf) all.smallest_angle = 0;
  return all;
}

}  // namespace frustum::mesh
