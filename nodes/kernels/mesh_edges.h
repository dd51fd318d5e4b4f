#pragma once
// The edges of triangles, each once, and which of them make a drawing.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/vertex_corners.h"

namespace frustum::kernels {

// An edge between vertices a < b. `faces` run along it; the first two of them are named, the second only where
// there is one. `turned`: those two run in opposite directions, as on a surface whose sides are told apart.
struct MeshEdge {
  std::uint32_t a, b;
  std::uint32_t faces;
  std::array<std::uint32_t, 2> face;
  bool turned;
};

// Every edge for which keep(edge) holds, ordered by a, then b. `place` gives every vertex the number of the
// vertex that it counts as; faces with two corners at one place have no edges. keep may be called from any
// thread. Cost: a sort among the edges of each vertex.
template <class Keep>
std::vector<MeshEdge> mesh_edges(std::span<const glm::uvec3> triangle, std::span<const std::uint32_t> place,
                                 const Keep& keep) {
  struct End {
    std::uint32_t vertex, face;
    bool arrives;
    auto operator<=>(const End&) const = default;
  };
  constexpr std::size_t block = 2048;
  const VertexCorners corners(triangle, place);
  const std::size_t n = corners.vertices();
  std::vector<std::vector<MeshEdge>> parts((n + block - 1) / block);
  parallel_blocks(n, block, [&](std::size_t begin, std::size_t end) {
    std::vector<MeshEdge>& found = parts[begin / block];
    std::vector<End> ends;
    for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
      ends.clear();
      for (const std::uint32_t k : corners.of(v)) {
        const std::uint32_t next = corners.next(k), previous = corners.previous(k);
        if (next == v || previous == v || next == previous) continue;
        if (next > v) ends.push_back({next, k / 3, false});
        if (previous > v) ends.push_back({previous, k / 3, true});
      }
      std::sort(ends.begin(), ends.end());
      for (std::size_t first = 0, last = 0; first < ends.size(); first = last) {
        while (last < ends.size() && ends[last].vertex == ends[first].vertex) ++last;
        const End &p = ends[first], &q = ends[std::min(first + 1, last - 1)];
        const MeshEdge edge{
            v, p.vertex, static_cast<std::uint32_t>(last - first), {p.face, q.face}, p.arrives != q.arrives};
        if (keep(edge)) found.push_back(edge);
      }
    }
  });
  std::vector<MeshEdge> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace frustum::kernels
