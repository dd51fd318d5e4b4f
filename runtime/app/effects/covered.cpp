#include "runtime/app/effects/covered.h"

#include <glm/geometric.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

// Width of the overlap of [low, high] and [0, size].
double within(double low, double high, double size) {
  return std::max(0.0, std::min(high, size) - std::max(low, 0.0));
}

}  // namespace

double covered_share(const Mesh& mesh) {
  if (mesh.space() != Space::screen || mesh.camera == nullptr) return 1;
  const double width = mesh.camera->resolution.x, height = mesh.camera->resolution.y;
  const Ref<Column> column = mesh.real<double>("position");
  const auto p = column->values<glm::dvec4>();
  double covered = 0;
  for (const glm::uvec3& t : mesh.triangles()) {
    const glm::dvec4 &a = p[t.x], &b = p[t.y], &c = p[t.z];
    const auto [left, right] = std::minmax({a.x, b.x, c.x});
    const auto [top, bottom] = std::minmax({a.y, b.y, c.y});
    const double area = std::fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
    covered += std::min(area, within(left, right, width) * within(top, bottom, height));
  }
  return covered < width * height ? covered / (width * height) : 1;
}

std::vector<PortRef> screen_meshes(const Graph& graph) {
  std::vector<PortRef> out;
  for (std::size_t n = 0; n < graph.nodes.size(); ++n) {
    const auto& ports = graph.nodes[n].type->outputs;
    for (std::size_t p = 0; p < ports.size(); ++p)
      if (ports[p].takes(buffer_type<Mesh>()) && ports[p].spaces.has(Space::screen)) out.push_back({n, p});
  }
  return out;
}

std::vector<double> covered_shares(const Graph& graph, const RunResult& run) {
  std::vector<double> share(graph.nodes.size(), -1);
  for (const PortRef p : screen_meshes(graph))
    if (const auto at = run.buffers.find(p); at != run.buffers.end())
      if (const auto mesh = at->second.as<Mesh>()) share[p.node] = covered_share(*mesh);
  for (std::size_t n = 0; n < graph.nodes.size(); ++n)  // in an order in which links lead forward
    for (const auto& list : graph.nodes[n].inputs)
      for (const Source& s : list)
        if (const auto* from = std::get_if<PortRef>(&s)) share[n] = std::max(share[n], share[from->node]);
  for (double& s : share)
    if (s < 0) s = 1;
  return share;
}

}  // namespace frustum
