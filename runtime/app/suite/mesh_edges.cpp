#include "runtime/app/suite/mesh_edges.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace frustum {
namespace {

// For each vertex, the first one at its position.
std::vector<std::uint32_t> places(const Mesh& mesh) {
  const Column& position = mesh.at("position");
  const int width = position.width();
  const auto coordinates = [&](std::uint32_t v) {
    std::array<double, 4> p{};
    for (int k = 0; k < width; ++k)
      p[static_cast<std::size_t>(k)] = position.number(v, k) + 0.0;  // -0 becomes +0
    return p;
  };
  std::vector<std::array<double, 4>> at(position.rows());
  for (std::uint32_t v = 0; v < at.size(); ++v) at[v] = coordinates(v);
  std::vector<std::uint32_t> order(at.size()), first(at.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return at[a] != at[b] ? at[a] < at[b] : a < b; });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && at[order[i]] == at[order[i - 1]] ? first[order[i - 1]] : order[i];
  return first;
}

}  // namespace

std::vector<MeshEdge> edges_of(const Mesh& mesh) {
  const auto place = places(mesh);
  std::vector<MeshEdge> edges;
  edges.reserve(mesh.faces() * 3);
  for (const glm::uvec3& t : mesh.triangles()) {
    const std::array<std::uint32_t, 3> v{place[t.x], place[t.y], place[t.z]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = v[k], b = v[(k + 1) % 3];
      edges.push_back(a < b ? MeshEdge{a, b, 1, 0} : MeshEdge{b, a, 0, 1});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const MeshEdge& a, const MeshEdge& b) {
    return a.low != b.low ? a.low < b.low : a.high < b.high;
  });
  std::size_t kept = 0;
  for (const MeshEdge& e : edges) {
    if (kept > 0 && edges[kept - 1].low == e.low && edges[kept - 1].high == e.high)
      edges[kept - 1].forward += e.forward, edges[kept - 1].backward += e.backward;
    else
      edges[kept++] = e;
  }
  edges.resize(kept);
  return edges;
}

}  // namespace frustum
