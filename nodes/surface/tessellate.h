// Bicubic patches as triangles that stay within a tolerance and meet without cracks.
//
// How finely: linear interpolation over a triangle whose (u, v) lie in a box of sides l, m is off by at most
//   (|Puu| l^2 + 2 |Puv| l m + |Pvv| m^2) / 8
// (Filip, Magedson & Markot 1986, theorem 1). Their proof is for right triangles; with barycentric weights
// w_k the error is at most sum w_k |H(x - x_k)| / 2, and the variance of a distribution on an interval of
// length l is at most l^2 / 4, so it holds for any triangle in the box. From it each patch needs n_u x n_v
// segments. An edge takes the largest count that one of its patches needs in its direction: the same whatever
// the order of the patches, and never coarser than the interior beside it.
//
// How without cracks: points of an edge are made once, from the edge's own control points. Inside, a patch is
// a grid; the strip between its outer ring and an edge is zipped by comparing midpoints, which keeps each
// triangle within one grid cell's width of parameters, so the bound above holds there, too.
#pragma once

#include "nodes/kernels/bicubic.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include <glm/vec2.hpp>

namespace frustum::tessellation {

using Patch = std::array<std::uint32_t, 16>;
using Triangle = glm::uvec3;

/// How far a world-space deviation may be in pixels. For points p, q of the patch's hull at depths z, z'
/// along the view axis, |p_xy / z - q_xy / z'| <= |p - q| |p| / (z z'); z and z' are at least the hull's
/// least depth (or the near plane: what is nearer is not seen) and |p| / z at most the secant of the angle to
/// the picture's corner.
struct PixelTolerance {
  glm::dvec3 eye, forward;  ///< forward: unit length
  double near_z = 0;
  double pixels = 0.5;
  double focal_px = 1;  ///< pixels per unit of x / z
  double corner_secant = 1;

  /// World units that a patch may deviate; no smaller anywhere on it.
  double world(const kernels::BicubicNet& net) const {
    double depth = std::numeric_limits<double>::infinity();
    for (const glm::dvec3& p : net) depth = std::min(depth, kernels::dot(p - eye, forward));
    return pixels * std::max(depth, near_z) / (focal_px * corner_secant);
  }
};

struct Segments {
  int u = 1, v = 1;
  bool limited = false;  ///< the tolerance asks for more than the limit
};

/// The counts n_u, n_v with the least product for which the bound is at most `tolerance`, rounded up and cut
/// to [low, high]. With r = n_u / n_v the choice r^2 = |Puu| / |Pvv| balances the two curvatures; any r > 0
/// keeps the bound.
inline Segments segments_of(const kernels::BicubicNet& net, double tolerance, int low, int high) {
  const auto m = kernels::bound_second_derivatives(net);
  // Between 1/16 and 16, so that a ruled patch does not put all its segments on one side.
  const double r = m.vv > 0 ? std::clamp(std::sqrt(m.uu / m.vv), 1.0 / 16, 16.0) : (m.uu > 0 ? 16.0 : 1.0);
  bool limited = false;
  const auto count = [&](double squares) {
    const double n = std::ceil(std::sqrt(squares / (4 * tolerance)));
    limited = limited || n > high;
    return n >= high ? high : std::max(static_cast<int>(n), low);
  };
  const int u = count(m.uu + m.uv * r), v = count(m.vv + m.uv / r);
  return {u, v, limited};
}

/// For each point the lowest index of a point at the same place, bit for bit (zeros of either sign are the
/// same).
inline std::vector<std::uint32_t> welded(std::span<const glm::dvec3> points) {
  std::map<std::tuple<double, double, double>, std::uint32_t> first;
  std::vector<std::uint32_t> to(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i)
    to[i] = first.try_emplace({points[i].x, points[i].y, points[i].z}, i).first->second;
  return to;
}

/// Sides of a patch, each with its points in the direction of growing u or v.
enum Side : std::size_t { u0, u1, v0, v1 };

inline std::array<std::uint32_t, 4> side_points(const Patch& p, Side side) {
  switch (side) {
    case u0: return {p[0], p[1], p[2], p[3]};
    case u1: return {p[12], p[13], p[14], p[15]};
    case v0: return {p[0], p[4], p[8], p[12]};
    default: return {p[3], p[7], p[11], p[15]};
  }
}

/// A boundary curve in its canonical direction: the one in which its control points come first by index.
struct Edge {
  std::array<std::uint32_t, 4> points{};
  int segments = 1;
  int forward_uses = 0, backward_uses = 0;  ///< by patches that lie on its left and right
  std::uint32_t first_vertex = 0;           ///< of those between its ends
  bool is_point() const { return points[0] == points[1] && points[0] == points[2] && points[0] == points[3]; }
};

struct SideUse {
  std::uint32_t edge = 0;
  bool reversed = false;
};

/// Which patches share which edges, and in how many segments each is cut.
struct Topology {
  std::vector<Edge> edges;
  std::vector<std::array<SideUse, 4>> sides;  ///< of each patch
  /// Every edge that is a curve has a patch on either side.
  bool closed() const {
    return std::all_of(edges.begin(), edges.end(), [](const Edge& e) {
      return e.is_point() || (e.forward_uses == 1 && e.backward_uses == 1);
    });
  }
};

inline Topology make_topology(std::span<const Patch> patches, std::span<const Segments> segments) {
  Topology t;
  std::map<std::array<std::uint32_t, 4>, std::uint32_t> known;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    auto& sides = t.sides.emplace_back();
    for (const Side side : {u0, u1, v0, v1}) {
      auto points = side_points(patches[p], side);
      const std::array backwards{points[3], points[2], points[1], points[0]};
      const bool reversed = backwards < points;
      if (reversed) points = backwards;
      const auto [at, fresh] = known.try_emplace(points, static_cast<std::uint32_t>(t.edges.size()));
      if (fresh) t.edges.push_back({.points = points});
      Edge& edge = t.edges[at->second];
      const bool along_v = side == u0 || side == u1;
      edge.segments = std::max(edge.segments, along_v ? segments[p].v : segments[p].u);
      // Counter-clockwise around the patch, v = 0 and u = 1 are walked with the parameter, the others against
      // it.
      const bool with_parameter = side == v0 || side == u1;
      ++(with_parameter != reversed ? edge.forward_uses : edge.backward_uses);
      sides[side] = {at->second, reversed};
    }
  }
  return t;
}

/// A corner of triangles inside one patch: a vertex of the mesh, and where it is on this patch.
struct LocalVertex {
  std::uint32_t vertex = 0;
  double u = 0, v = 0;
};

/// The triangles of one patch, over its own local vertices.
class PatchMesh {
 public:
  std::vector<LocalVertex> vertices;
  std::vector<Triangle> triangles;  ///< counter-clockwise in (u, v)

  /// Adds the points of a side, `vertex(i)` being the i-th of segments + 1.
  template <class VertexAt>
  std::vector<std::uint32_t> add_side(Side side, int segments, VertexAt&& vertex) {
    std::vector<std::uint32_t> row;
    for (int i = 0; i <= segments; ++i) {
      const double t = static_cast<double>(i) / segments;
      row.push_back(static_cast<std::uint32_t>(vertices.size()));
      vertices.push_back(
          {vertex(i), side == u0 ? 0 : (side == u1 ? 1 : t), side == v0 ? 0 : (side == v1 ? 1 : t)});
    }
    return row;
  }

  /// Triangles between two rows of vertices. Seen with the rows upwards, `left` lies left of `right`; `along`
  /// is the parameter that grows along both. Each vertex goes to the nearest one opposite.
  void zip(const std::vector<std::uint32_t>& left, const std::vector<std::uint32_t>& right,
           double LocalVertex::*along) {
    const auto middle = [&](const std::vector<std::uint32_t>& row, std::size_t i) {
      return vertices[row[i]].*along + vertices[row[i + 1]].*along;
    };
    std::size_t i = 0, j = 0;
    while (i + 1 < left.size() || j + 1 < right.size()) {
      const bool step_left =
          j + 1 == right.size() || (i + 1 < left.size() && middle(left, i) <= middle(right, j));
      if (step_left) {
        add(left[i], right[j], left[i + 1]);
        ++i;
      } else {
        add(left[i], right[j], right[j + 1]);
        ++j;
      }
    }
  }

  /// Leaves out triangles that have collapsed to a line: two of their corners are one vertex.
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const auto x = vertices[a].vertex, y = vertices[b].vertex, z = vertices[c].vertex;
    if (x != y && y != z && z != x) triangles.push_back({a, b, c});
  }
};

/// Whether a patch is one strip between two opposite sides, without vertices inside: the sides across are
/// straight enough to be single segments.
inline bool is_strip(int across, int first_side, int second_side) {
  return across == 1 && first_side == 1 && second_side == 1;
}

/// Vertices inside a patch of n_u x n_v segments with the given counts of its sides: (u - 1) (v - 1) of the
/// result, which is {1, 1} for a strip.
inline Segments interior_grid(Segments n, const std::array<int, 4>& side_segments) {
  if (is_strip(n.u, side_segments[v0], side_segments[v1]) ||
      is_strip(n.v, side_segments[u0], side_segments[u1]))
    return {};
  return {.u = std::max(n.u, 2), .v = std::max(n.v, 2)};
}

/// Triangulates a patch. `side_vertex(side, i)` names the vertices of the sides in their own parameter; those
/// inside are first_inside, ... row by row in u.
template <class SideVertex>
PatchMesh triangulate(Segments n, const std::array<int, 4>& side_segments, std::uint32_t first_inside,
                      SideVertex&& side_vertex) {
  PatchMesh mesh;
  std::array<std::vector<std::uint32_t>, 4> side;
  for (const Side s : {u0, u1, v0, v1})
    side[s] = mesh.add_side(s, side_segments[s], [&](int i) { return side_vertex(s, i); });

  if (is_strip(n.u, side_segments[v0], side_segments[v1])) {
    mesh.zip(side[u0], side[u1], &LocalVertex::v);
    return mesh;
  }
  if (is_strip(n.v, side_segments[u0], side_segments[u1])) {
    mesh.zip(side[v1], side[v0], &LocalVertex::u);
    return mesh;
  }

  const Segments grid = interior_grid(n, side_segments);
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto inside = [&](int i, int j) {
    return first + static_cast<std::uint32_t>((i - 1) * (grid.v - 1) + (j - 1));
  };
  for (int i = 1; i < grid.u; ++i)
    for (int j = 1; j < grid.v; ++j)
      mesh.vertices.push_back({first_inside + inside(i, j) - first, static_cast<double>(i) / grid.u,
                               static_cast<double>(j) / grid.v});
  for (int i = 1; i + 1 < grid.u; ++i)
    for (int j = 1; j + 1 < grid.v; ++j) {
      mesh.add(inside(i, j), inside(i + 1, j), inside(i + 1, j + 1));
      mesh.add(inside(i, j), inside(i + 1, j + 1), inside(i, j + 1));
    }

  std::vector<std::uint32_t> near_u0, near_u1, near_v0, near_v1;
  for (int j = 1; j < grid.v; ++j) near_u0.push_back(inside(1, j)), near_u1.push_back(inside(grid.u - 1, j));
  for (int i = 1; i < grid.u; ++i) near_v0.push_back(inside(i, 1)), near_v1.push_back(inside(i, grid.v - 1));
  mesh.zip(side[u0], near_u0, &LocalVertex::v);
  mesh.zip(near_u1, side[u1], &LocalVertex::v);
  mesh.zip(near_v0, side[v0], &LocalVertex::u);  // u upwards puts larger v on the left
  mesh.zip(side[v1], near_v1, &LocalVertex::u);
  return mesh;
}

}  // namespace frustum::tessellation
