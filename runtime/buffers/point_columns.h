// The columns of a mesh as planes of visible points (runtime/buffers/image.h says what they are called).
#pragma once

#include "nodes/kernels/interpolate_attributes.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/tiled.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

// Columns of real numbers of vertices, corners or faces; none for others.
std::optional<kernels::AttributeDomain> domain_of(const Column&);

// The planes of a column's values, and those of their changes per pixel by x and then by y.
std::vector<std::string> value_names(const Column&);
std::vector<std::string> slope_names(const Column&);

// Texture coordinates and world positions have slopes: how much of either a pixel sees.
bool has_slopes(const Column&);

// A column and where its planes stand in the frame: `first` is its first value, followed by its other
// components; then, where it has slopes, those by x and those by y.
struct PointColumn {
  Ref<Column> column;
  kernels::AttributeDomain domain;
  std::size_t width, first;
  bool slopes;
  bool constant = false;  // over each face: the first corner's row stands for all

  // Adds the planes of `column`, which has a domain, in the precision R.
  template <class R>
  static PointColumn add(const Ref<Column>& column, bool slopes, PlaneList& planes) {
    PointColumn to{as_real<R>(column), *domain_of(*column), static_cast<std::size_t>(column->width()),
                   planes.size(), slopes};
    for (const std::string& name : value_names(*column)) planes.push_back({name, plane_kind_of<R>});
    if (!slopes) return to;
    for (const std::string& name : slope_names(*column)) planes.push_back({name, plane_kind_of<R>});
    return to;
  }
};

// The rectangle of a tile in one plane; without data where nobody reads it.
template <class T>
kernels::PlaneView<T> plane_view(const Tile& tile, std::size_t plane) {
  const int i = static_cast<int>(plane);
  if (!tile.has(i)) return {};
  return {tile.row<T>(i, 0, tile.rect().y0), tile.row_stride(), tile.sample_stride()};
}

// What of a column is read by somebody.
template <class R>
std::optional<kernels::Attribute<R>> wanted_planes(const PointColumn& s, const Tile& to) {
  kernels::Attribute<R> a{static_cast<const R*>(s.column->data()), static_cast<int>(s.width), s.domain};
  bool any = false;
  for (std::size_t i = 0; i < s.width; ++i) {
    a.value[i] = plane_view<R>(to, s.first + i);
    if (s.slopes) {
      a.dx[i] = plane_view<R>(to, s.first + s.width + i);
      a.dy[i] = plane_view<R>(to, s.first + 2 * s.width + i);
    }
    any = any || a.value[i].data != nullptr || a.dx[i].data != nullptr || a.dy[i].data != nullptr;
  }
  return any ? std::optional(a) : std::nullopt;
}

}  // namespace frustum
