// Triangles of what a PLY file calls faces.
#pragma once

#include "runtime/buffers/column.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace frustum::ply {

template <class R>
struct Lists;

struct Cut {
  std::vector<glm::uvec3> triangles;
  std::vector<glm::uvec3> corners;   // of each triangle: places in the piece's indices
  std::vector<std::uint32_t> faces;  // of each triangle: the row it comes from
  std::uint64_t fans = 0, skipped = 0;
};

struct CutParts {
  bool corners = false, faces = false;  // whether these are filled
};

// Polygons of the lists, whose first row is `first`; those of fewer than 3 corners are counted as skipped.
template <class R>
void cut_faces(const Lists<R>& lists, std::uint64_t first, std::span<const glm::vec<3, R>> positions,
               CutParts parts, Cut& out);

// Strips of `sizes` indices each; ~0 begins a new one. Every second triangle is turned round; one that
// repeats an index, which only moves on, is left out.
void cut_strips(std::span<const std::uint32_t> sizes, std::span<const std::uint32_t> indices, Cut& out);

// Column `uv` of the corners of all triangles: those of cut i begin at first[i] and take their coordinates
// from lists[i]. Strips have 0, 0.
template <class R>
std::shared_ptr<Column> gather_corner_uv(std::span<const Cut> cuts, std::span<const std::size_t> first,
                                         std::span<const Lists<R>> lists, std::size_t triangles);

// A column of faces of the file as one of triangles. Strips have 0.
Ref<Column> gather_face_column(const Column& from, std::span<const Cut> cuts,
                               std::span<const std::size_t> first, std::size_t triangles);

}  // namespace frustum::ply
