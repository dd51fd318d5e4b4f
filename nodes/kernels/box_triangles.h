// Which pixels a screen triangle may cover: its bounding box, cut to a window.
#pragma once

#include "nodes/kernels/sample_positions.h"
#include "nodes/kernels/screen_triangle.h"

namespace frustum::kernels {

// Pixels x0 <= x < x1, y0 <= y < y1.
struct PixelRect {
  int x0, y0, x1, y1;

  bool empty() const { return x0 >= x1 || y0 >= y1; }
  bool operator==(const PixelRect&) const = default;
};
inline PixelRect intersection(const PixelRect& a, const PixelRect& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

// A triangle that touches the window, and its pixels counted from the window's corner, both ends included.
struct BoxedTriangle {
  std::uint32_t face;
  std::uint16_t x0, y0, x1, y1;
};

// What became of the triangles that were looked at; those neither boxed nor counted here miss every sample.
struct BoxCounts {
  std::size_t boxed = 0;
  std::uint64_t out_of_range = 0, without_area = 0;
};

// Pixels that may have a sample within [least, greatest] (2^-8 px), where the offsets of samples lie within
// [lo, hi].
struct PixelRange {
  std::int64_t first, last;
};
inline PixelRange pixels_between(std::int32_t least, std::int32_t greatest, int lo, int hi) {
  constexpr std::int64_t scale = sample_unit / corner_unit;
  return {(least * scale - hi + sample_unit - 1) >> sample_bits, (greatest * scale - lo) >> sample_bits};
}

// Writes the face to `out` if it may cover a sample of the window. `samples` holds the offsets of all
// samples.
//   window  at most 65536 px wide and high
template <std::floating_point R>
void box_triangle(const ScreenMesh<R>& mesh, std::uint32_t face, const SampleBox& samples,
                  const PixelRect& window, BoxedTriangle* out, BoxCounts& counts) {
  std::array<GridPoint, 3> p;
  for (int k = 0; k < 3; ++k) {
    const auto snapped = snap(mesh.position[mesh.face[face][k]], mesh.corner_bits);
    if (!snapped) {
      ++counts.out_of_range;
      return;
    }
    p[static_cast<std::size_t>(k)] = *snapped;
  }
  if (twice_area(p[0], p[1], p[2]) == 0) {
    ++counts.without_area;
    return;
  }
  const auto [left, right] = std::minmax({p[0].x, p[1].x, p[2].x});
  const auto [top, bottom] = std::minmax({p[0].y, p[1].y, p[2].y});
  const PixelRange x = pixels_between(left, right, samples.x0, samples.x1);
  const PixelRange y = pixels_between(top, bottom, samples.y0, samples.y1);
  const std::int64_t x0 = std::max<std::int64_t>(x.first - window.x0, 0);
  const std::int64_t y0 = std::max<std::int64_t>(y.first - window.y0, 0);
  const std::int64_t x1 = std::min<std::int64_t>(x.last, window.x1 - 1) - window.x0;
  const std::int64_t y1 = std::min<std::int64_t>(y.last, window.y1 - 1) - window.y0;
  if (x0 > x1 || y0 > y1) return;
  const auto narrow = [](std::int64_t v) { return static_cast<std::uint16_t>(v); };
  out[counts.boxed++] = {face, narrow(x0), narrow(y0), narrow(x1), narrow(y1)};
}

// Boxes the faces [begin, end) in order. `out` has room for all of them; the result says how many were
// written. This is the truth that simd/box_triangles.h is held against.
template <std::floating_point R>
BoxCounts box_triangles(const ScreenMesh<R>& mesh, std::uint32_t begin, std::uint32_t end,
                        const SampleBox& samples, const PixelRect& window, BoxedTriangle* out) {
  BoxCounts counts;
  for (std::uint32_t face = begin; face < end; ++face) box_triangle(mesh, face, samples, window, out, counts);
  return counts;
}

}  // namespace frustum::kernels
