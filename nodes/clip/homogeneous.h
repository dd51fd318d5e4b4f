// Triangles of a mesh against the view volume, before the divide by w.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/clip.h"
#include "nodes/kernels/parallel.h"
#include "nodes/kernels/stencil.h"

namespace frustum::clip {

// Which planes cut. Faces wholly outside any one of the six sides of the view volume go in every case.
struct Cutting {
  kernels::ClipSpace space = {};
  bool near_only = false;
  double guard_band = 1;  // >= 1: half-width, in w, of the band that cuts in x and y
};

enum class Verdict : std::uint8_t { drop, keep, cut, undefined };

// What the planes say to each face. `undefined`: a corner is not finite.
struct Verdicts {
  std::vector<Verdict> face;  // empty when all are kept
  std::size_t dropped = 0, cut = 0, undefined = 0;
  bool all_kept() const { return dropped + cut + undefined == 0; }
};

namespace detail {

// Per vertex: the sides it is outside of (low byte), the cutting planes it is outside of (high byte); bit 15:
// not finite.
inline constexpr std::uint16_t not_finite = 0x8000;

template <std::floating_point R>
std::uint16_t vertex_code(const Cutting& c, const glm::vec<4, R>& p) {
  const unsigned outside = kernels::volume_outcode(c.space, R(1), p);
  unsigned cutting =
      c.guard_band == 1 ? outside : kernels::volume_outcode(c.space, static_cast<R>(c.guard_band), p);
  if (c.near_only) cutting &= 1;
  const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && std::isfinite(p.w);
  return static_cast<std::uint16_t>(outside | cutting << 8 | (finite ? 0U : not_finite));
}

inline Verdict verdict(unsigned a, unsigned b, unsigned c) {
  const unsigned any = a | b | c;
  if (any == 0) return Verdict::keep;
  if ((any & not_finite) != 0) return Verdict::undefined;
  if ((a & b & c & 0xff) != 0) return Verdict::drop;
  return (any >> 8) != 0 ? Verdict::cut : Verdict::keep;
}

}  // namespace detail

// The first vertex outside a side of the volume, or not finite; position.size() where all are inside. Faces of
// such vertices alone are kept whole whatever the planes.
template <std::floating_point R>
std::size_t first_outside(const Cutting& cutting, std::span<const glm::vec<4, R>> position) {
  return kernels::first_where(position.size(),
                              [&](std::size_t i) { return detail::vertex_code(cutting, position[i]) != 0; });
}

// One pass over the vertices; one over the faces unless no vertex is outside.
template <std::floating_point R>
Verdicts judge(const Cutting& cutting, std::span<const glm::vec<4, R>> position,
               std::span<const glm::uvec3> triangle) {
  std::vector<std::uint16_t> code(position.size());
  std::atomic<unsigned> any{0};
  kernels::parallel_blocks(position.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    unsigned here = 0;
    for (std::size_t i = begin; i < end; ++i) here |= code[i] = detail::vertex_code(cutting, position[i]);
    if (here != 0) any |= here;
  });
  Verdicts v;
  if (any == 0) return v;
  v.face.resize(triangle.size());
  std::atomic<std::size_t> count[4] = {};
  kernels::parallel_blocks(triangle.size(), kernels::usual_block, [&](std::size_t begin, std::size_t end) {
    std::size_t here[4] = {};
    for (std::size_t f = begin; f < end; ++f) {
      const auto& t = triangle[f];
      v.face[f] = detail::verdict(code[t.x], code[t.y], code[t.z]);
      ++here[static_cast<std::size_t>(v.face[f])];
    }
    for (std::size_t k = 0; k < 4; ++k) count[k] += here[k];
  });
  v.dropped = count[static_cast<std::size_t>(Verdict::drop)];
  v.cut = count[static_cast<std::size_t>(Verdict::cut)];
  v.undefined = count[static_cast<std::size_t>(Verdict::undefined)];
  return v;
}

// What is left of the cut faces: triangles over the old vertices (indices below `old_vertices`) and new ones
// after them.
template <std::floating_point R>
struct Pieces {
  std::vector<std::uint32_t> source;     // of each piece: the face it is of, ascending
  std::vector<glm::uvec3> triangle;      // of each piece, winding as in its face
  std::vector<glm::vec<4, R>> position;  // of each new vertex
  kernels::Stencils vertices;            // each new vertex, from the old vertices
  kernels::Stencils corners;             // each corner of each piece, from the old corners 3 f + k
};

namespace detail {

// A row of weights over three sources, ascending, so that both neighbours of an edge add in the same order.
inline void add_row(kernels::Stencils& rows, glm::uvec3 source, glm::dvec3 weight) {
  const auto order = [&](glm::length_t i, glm::length_t j) {
    if (source[i] > source[j]) std::swap(source[i], source[j]), std::swap(weight[i], weight[j]);
  };
  order(0, 1), order(1, 2), order(0, 1);
  for (glm::length_t k = 0; k < 3; ++k)
    if (weight[k] != 0) rows.pair(source[k], weight[k]);
  rows.end_row();
}

// Appends the pieces of one face; new vertices are numbered from `next` on.
template <std::floating_point R>
void add_pieces(const kernels::ClipRing<R>& ring, std::uint32_t face, const glm::uvec3& t, std::uint32_t next,
                Pieces<R>& out) {
  if (ring.size < 3) return;
  std::array<std::uint32_t, 28> index{};
  for (std::size_t k = 0; k < ring.size; ++k) {
    const auto& v = ring.vertex[k];
    if (v.corner >= 0) {
      index[k] = t[v.corner];
      continue;
    }
    index[k] = next + static_cast<std::uint32_t>(out.position.size());
    out.position.push_back(v.p);
    add_row(out.vertices, t, v.weights);
  }
  for (std::size_t k = 1; k + 1 < ring.size; ++k) {  // convex, so a fan from its first corner
    out.source.push_back(face);
    out.triangle.emplace_back(index[0], index[k], index[k + 1]);
    for (const std::size_t c : {std::size_t{0}, k, k + 1})
      add_row(out.corners, {3 * face, 3 * face + 1, 3 * face + 2}, ring.vertex[c].weights);
  }
}

template <std::floating_point R>
void append(Pieces<R>& all, const Pieces<R>& more, std::uint32_t old_vertices) {
  const auto shift = static_cast<std::uint32_t>(all.position.size());
  all.source.insert(all.source.end(), more.source.begin(), more.source.end());
  for (const auto& t : more.triangle) {
    glm::uvec3 moved = t;
    for (glm::length_t k = 0; k < 3; ++k) moved[k] += moved[k] >= old_vertices ? shift : 0;
    all.triangle.push_back(moved);
  }
  all.position.insert(all.position.end(), more.position.begin(), more.position.end());
  all.vertices.append(more.vertices);
  all.corners.append(more.corners);
}

}  // namespace detail

// Clips the faces listed. Parallel in blocks whose results are joined in order: the same bytes for any number
// of threads.
template <std::floating_point R>
Pieces<R> cut_faces(const Cutting& cutting, std::span<const glm::vec<4, R>> position,
                    std::span<const glm::uvec3> triangle, std::span<const std::uint32_t> faces) {
  constexpr std::size_t block = 1024;
  const auto planes = kernels::view_volume(cutting.space, cutting.guard_band);
  const auto old_vertices = static_cast<std::uint32_t>(position.size());
  std::vector<Pieces<R>> part((faces.size() + block - 1) / block);
  kernels::parallel_blocks(faces.size(), block, [&](std::size_t begin, std::size_t end) {
    auto& out = part[begin / block];
    for (std::size_t i = begin; i < end; ++i) {
      const auto& t = triangle[faces[i]];
      unsigned code = 0;
      for (glm::length_t k = 0; k < 3; ++k) code |= detail::vertex_code(cutting, position[t[k]]);
      const auto ring = kernels::clip_triangle(planes, static_cast<std::uint8_t>(code >> 8), position[t.x],
                                               position[t.y], position[t.z]);
      detail::add_pieces(ring, faces[i], t, old_vertices, out);
    }
  });
  Pieces<R> all;
  for (const auto& p : part) detail::append(all, p, old_vertices);
  return all;
}

}  // namespace frustum::clip
