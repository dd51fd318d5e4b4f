// Normals of a smooth surface that triangles stand for, with creases.
#pragma once

#include <algorithm>
#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "nodes/kernels/parallel.h"
#include "nodes/kernels/surface_measures.h"
#include "nodes/kernels/vector.h"
#include "nodes/kernels/vertex_corners.h"

namespace frustum::mesh {

// What a face counts for in the normal at one of its corners.
enum class NormalWeight : std::uint8_t {
  angle,   // its angle there: does not change with the triangulation. Thuermer & Wuethrich 1998
  area,    // its area: the cross products, summed
  uniform  // all alike: Gouraud 1971
};

struct FaceNormal {
  glm::dvec3 unit{0};  // 0: no area, or a corner that is not finite
  double area = 0;     // in the square of the unit that the largest coordinate has
};

// Normals of all faces, in double from scaled coordinates, within some 10 u of the plane's.
template <std::floating_point R>
std::vector<FaceNormal> face_normals(const kernels::Triangles<R>& mesh) {
  double largest = 0;
  const kernels::Box box = kernels::bounds_of(mesh);
  if (!box.empty())
    largest = std::max(kernels::largest_component(box.low), kernels::largest_component(box.high));
  const double scale = largest > 0 ? kernels::power_of_two_towards_one(largest) : 1;
  std::vector<FaceNormal> normals(mesh.triangle.size());
  kernels::parallel_blocks(normals.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (!mesh.finite(f)) continue;
      const auto [a, b, c] = mesh.corners(f);
      const glm::dvec3 across = kernels::cross((b - a) * scale, (c - a) * scale);
      if (const auto unit = kernels::normalized(across)) normals[f] = {*unit, kernels::norm(across) / 2};
    }
  });
  return normals;
}

struct NormalOptions {
  NormalWeight weight;
  double crease;  // radians; an edge whose faces' normals differ by more is sharp
};

// The normals at the corners around one vertex. Corners whose faces share a smooth edge there are one fan and
// get one normal: the weighted sum of the fan's face normals, made unit. An edge is smooth where exactly two
// faces with a normal run along it, in opposite directions, at an angle of at most the crease.
template <std::floating_point R>
class Fans {
 public:
  Fans(const kernels::Triangles<R>& mesh, const kernels::VertexCorners& corners,
       const std::vector<FaceNormal>& faces, const NormalOptions& options)
      : mesh_(mesh), corners_(corners), faces_(faces), options_(options) {}

  // Calls put(corner, normal) for every corner of vertex v; the normal is 0 where the fan has none.
  template <class Put>
  void at(std::size_t v, const Put& put) {
    const auto around = corners_.of(v);
    sets_.reset(around.size());
    join_smooth_edges(around);
    sums_.assign(around.size(), glm::dvec3(0));
    for (std::uint32_t i = 0; i < around.size(); ++i)
      sums_[sets_.find(i)] += faces_[around[i] / 3].unit * weight(around[i]);
    for (std::uint32_t i = 0; i < around.size(); ++i)
      put(around[i], kernels::normalized_or(sums_[sets_.find(i)], faces_[around[i] / 3].unit));
  }

  // The unit normal of all faces around v together; nothing where none has a direction, or they cancel.
  std::optional<glm::dvec3> over_all(std::size_t v) const {
    glm::dvec3 sum(0);
    for (const std::uint32_t k : corners_.of(v)) sum += faces_[k / 3].unit * weight(k);
    return kernels::normalized(sum);
  }

  double weight(std::size_t corner) const {
    const FaceNormal& face = faces_[corner / 3];
    if (options_.weight == NormalWeight::uniform || face.area == 0) return 1;
    if (options_.weight == NormalWeight::area) return face.area;
    const auto p = mesh_.corners(corner / 3);
    const std::size_t c = corner % 3;
    return kernels::angle_between(p[(c + 1) % 3] - p[c], p[(c + 2) % 3] - p[c]);
  }

 private:
  struct End {
    std::uint32_t vertex;  // at the other end of an edge from v
    std::uint32_t corner;  // which of the corners around v has the edge
    bool arrives;          // the face runs along the edge towards v
  };

  void join_smooth_edges(std::span<const std::uint32_t> around) {
    ends_.clear();
    for (std::uint32_t i = 0; i < around.size(); ++i) {
      if (faces_[around[i] / 3].area == 0) continue;
      ends_.push_back({corners_.next(around[i]), i, false});
      ends_.push_back({corners_.previous(around[i]), i, true});
    }
    std::sort(ends_.begin(), ends_.end(), [](const End& a, const End& b) {
      return std::tie(a.vertex, a.corner, a.arrives) < std::tie(b.vertex, b.corner, b.arrives);
    });
    for (std::size_t first = 0, last = 0; first < ends_.size(); first = last) {
      while (last < ends_.size() && ends_[last].vertex == ends_[first].vertex) ++last;
      const End &a = ends_[first], &b = ends_[last - 1];
      if (last - first != 2 || a.arrives == b.arrives) continue;
      const auto &m = faces_[around[a.corner] / 3].unit, &n = faces_[around[b.corner] / 3].unit;
      if (kernels::angle_between(m, n) <= options_.crease) sets_.join(a.corner, b.corner);
    }
  }

  const kernels::Triangles<R>& mesh_;
  const kernels::VertexCorners& corners_;
  const std::vector<FaceNormal>& faces_;
  const NormalOptions options_;
  std::vector<End> ends_;
  std::vector<glm::dvec3> sums_;
  kernels::DisjointSets sets_;
};

// Where there is no direction: a vertex without faces, or with none that has an area.
inline constexpr glm::dvec3 no_direction{0, 0, 1};

// to[k] is the normal at corner k. `place` gives every vertex the number of the one it is joined with.
// Returns how many corners have no direction and got (0, 0, 1); corners of faces without area among others
// get their vertex's sum over all fans. Requires 3 rows a face. Cost: about n log n in the faces at a vertex.
template <std::floating_point R>
std::size_t corner_normals(const kernels::Triangles<R>& mesh, std::span<const std::uint32_t> place,
                           const NormalOptions& options, std::span<glm::vec<3, R>> to) {
  const auto faces = face_normals(mesh);
  const kernels::VertexCorners corners(mesh.triangle, place);
  std::atomic<std::size_t> without{0};
  kernels::parallel_blocks(corners.vertices(), 2048, [&](std::size_t begin, std::size_t end) {
    Fans<R> fans(mesh, corners, faces, options);
    for (std::size_t v = begin; v < end; ++v) {
      std::optional<std::optional<glm::dvec3>> whole;  // found once, and only where it is asked for
      fans.at(v, [&](std::uint32_t k, const glm::dvec3& n) {
        if (n != glm::dvec3(0)) {
          to[k] = glm::vec<3, R>(n);
          return;
        }
        if (!whole) whole = fans.over_all(v);
        to[k] = glm::vec<3, R>(whole->value_or(no_direction));
        if (!*whole) without.fetch_add(1, std::memory_order_relaxed);
      });
    }
  });
  return without;
}

// to[v] is the normal at vertex v: the weighted sum over all faces there, whatever the angle between them; in
// case they cancel, the first face's. Returns how many vertices that a face uses have no direction.
template <std::floating_point R>
std::size_t vertex_normals(const kernels::Triangles<R>& mesh, std::span<const std::uint32_t> place,
                           NormalWeight weight, std::span<glm::vec<3, R>> to) {
  const auto faces = face_normals(mesh);
  const kernels::VertexCorners corners(mesh.triangle, place);
  std::atomic<std::size_t> without{0};
  kernels::parallel_blocks(corners.vertices(), 2048, [&](std::size_t begin, std::size_t end) {
    const Fans<R> fans(mesh, corners, faces, {weight, 0});
    for (std::size_t v = begin; v < end; ++v) {
      glm::dvec3 sum(0), first(0);
      const auto around = corners.of(place[v]);
      for (const std::uint32_t k : around) {
        const glm::dvec3& n = faces[k / 3].unit;
        if (first == glm::dvec3(0)) first = n;
        sum += n * fans.weight(k);
      }
      const auto unit = kernels::normalized(sum);
      const glm::dvec3 n = unit ? *unit : first;
      const bool none = n == glm::dvec3(0);
      to[v] = glm::vec<3, R>(none ? no_direction : n);
      if (none && !around.empty()) without.fetch_add(1, std::memory_order_relaxed);
    }
  });
  return without;
}

}  // namespace frustum::mesh
