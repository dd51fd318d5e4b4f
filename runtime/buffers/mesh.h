// Triangles: columns over vertices, corners and faces.
#pragma once

#include "runtime/buffers/camera.h"
#include "runtime/buffers/column.h"
#include "runtime/buffers/material.h"

#include <optional>
#include <string_view>
#include <vector>

namespace frustum {

// Columns that have a meaning here; others are carried along unread.
//
//   name       domain           type          meaning                                                       required
//   triangle   face             u32 x 3       vertex indices, counter-clockwise seen from the front         yes
//   position   vertex           real x 3, 4   in its space(); width 4 in clip (x y z w) and screen          yes
//                                             (x_px, y_px, z, 1/w) space
//   normal     vertex, corner   real x 3      unit length, world space (object space before a transform)    no
//   uv         vertex, corner   real x 2      texture coordinates; further sets are uv1, uv2 ...            no
//   color      vertex, corner   real x 3, 4   linear Rec.709 (and opacity), scales the materials' colours   no
//   world      vertex           real x 3      position in world space, kept from project.view on            no
//   origin     face             u32           which triangle of the source mesh this face comes from        no: itself
//   material   face             u32           index into materials                                          no: 0
//
// Corner c of face f is row 3 f + c of a corner column.
// Invariants (validate): every column has as many rows as its domain has elements; indices < vertices.
struct Mesh {
  std::vector<Ref<Column>> columns;
  Ref<MaterialSet> materials;  // null: one default material
  Ref<Camera> camera;          // from project.view on: the camera whose spaces the positions are in
  std::optional<bool> closed;  // every edge has two faces, of opposite direction; unset: not known

  const Column* find(std::string_view name) const;
  Ref<Column> share(std::string_view name) const;  // null where there is none
  const Column& at(std::string_view name) const;   // throws NodeError("missing_column") where there is none
  std::size_t vertices() const;
  std::size_t faces() const;
  Space space() const;  // of the position column
  std::span<const glm::uvec3> triangles() const;

  // The same mesh with one column replaced or added.
  Mesh with(Ref<Column> column) const;
  // A column as R x width elements: `mesh.real<float>("normal", 3)`.
  template <class R>
  Ref<Column> real(std::string_view name) const {
    Ref<Column> c = share(name);
    if (!c) at(name);
    return as_real<R>(std::move(c));
  }

  // What breaks the invariants, or an empty text.
  std::string validate() const;
};

template <>
const BufferType& buffer_type<Mesh>();

}  // namespace frustum
