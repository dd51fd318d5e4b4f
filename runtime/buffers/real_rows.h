// Rows of real planes in the precision of the node that reads them.
#pragma once

#include "runtime/core/context.h"
#include "runtime/core/tiled.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace frustum {

// A plane that a node reads as Real numbers; index < 0: it does not exist.
struct RealPlane {
  int index = -1;
  PlaneKind kind = PlaneKind::f32;
  explicit operator bool() const { return index >= 0; }
};

// Names a plane to be read by tile(). Widening is silent; narrowing f64 to single precision is a decision of
// the graph's author and throws NodeError("narrowing"). Throws NodeError("missing_plane") where there is none
// of that name, and NodeError("wrong_plane") for integers.
template <class T>
RealPlane read_real(const Tiled<T>& in, std::string_view name, Precision precision) {
  const int index = in.read(name);
  const PlaneKind kind = in.frame().planes[static_cast<std::size_t>(index)].kind;
  if (kind == PlaneKind::u32)
    throw NodeError("wrong_plane", "plane '" + std::string(name) + "' holds integers");
  if (kind == PlaneKind::f64 && precision == Precision::single)
    throw NodeError("narrowing",
                    "plane '" + std::string(name) + "' is double, and this node computes in single");
  return {index, kind};
}

// The row as R: the tile's own, or its values widened into `scratch` (tile.rect().width() elements or more).
// Null for a plane that does not exist.
template <class R>
const R* real_row(const Tile& tile, RealPlane plane, int sample, int y, std::span<R> scratch) {
  if (!plane) return nullptr;
  if (plane.kind == plane_kind_of<R>) return tile.row<const R>(plane.index, sample, y);
  if constexpr (std::is_same_v<R, double>) {
    const float* from = tile.row<const float>(plane.index, sample, y);
    for (int x = 0; x < tile.rect().width(); ++x) scratch[static_cast<std::size_t>(x)] = from[x];
    return scratch.data();
  }
  return nullptr;
}

// Where to write a row: null where nobody reads the plane.
template <class R>
R* out_row(const Tile& tile, int plane, int sample, int y) {
  return tile.has(plane) ? tile.row<R>(plane, sample, y) : nullptr;
}

constexpr PlaneKind real_kind(Precision p) {
  return p == Precision::single ? PlaneKind::f32 : PlaneKind::f64;
}

}  // namespace frustum
