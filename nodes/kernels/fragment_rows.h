// Rows of fragments: where a triangle covers a row, how deep it is there, and how it gets its place in the layers.
#pragma once

#include "nodes/kernels/fill_triangles.h"

namespace frustum::kernels {

// The layers of a row of `width` pixels at one sample. Strides count elements, from one layer to the next.
template <std::floating_point R>
struct FragmentRow {
  std::uint32_t* id;  // of the nearest layer
  R* z;               // infinite where a layer holds nothing
  std::ptrdiff_t id_stride, z_stride;
  std::uint32_t* count;  // fragments so far, no more than there are layers
  R* cut;                // as FragmentScratch
  int width, layers;
};

// Columns [x0, x1) of a row.
struct PixelSpan {
  int x0, x1;
  bool empty() const { return x0 >= x1; }
};

// Cuts a span to the pixels where a linear function is not negative: `first` at span.x0, `step` a pixel. Exact:
// |first| < 2^61, and 2^16 steps of at most 2^38 stay within 64 bits.
inline PixelSpan cut_span(PixelSpan span, std::int64_t first, std::int64_t step) {
  const std::int64_t last = first + (span.x1 - 1 - span.x0) * step;
  if (first >= 0 && last >= 0) return span;
  if (first < 0 && last < 0) return {span.x0, span.x0};
  if (first < 0) return {span.x0 + static_cast<int>((step - 1 - first) / step), span.x1};
  return {span.x0, span.x0 + static_cast<int>(first / -step) + 1};
}

// Where the sample at the offset (ox, oy) of a box's pixels lies inside a triangle, row by row from the top. Exact.
class RowSpans {
 public:
  RowSpans(const std::array<Edge, 3>& edges, int ox, int oy, const PixelRect& box) : box_{box.x0, box.x1} {
    for (std::size_t k = 0; k < 3; ++k) {
      const Edge& e = edges[k];
      line_[k] = {e.at_pixel(box.x0, box.y0) + e.at_offset(ox, oy), std::int64_t{e.a} * corner_unit,
                  std::int64_t{e.b} * corner_unit};
    }
  }
  // Of a row; the next call gives that of the row below.
  PixelSpan next() {
    PixelSpan span = box_;
    for (Line& l : line_) {
      if (!span.empty()) span = cut_span(span, l.first + (span.x0 - box_.x0) * l.across, l.across);
      l.first += l.down;
    }
    return span;
  }

 private:
  struct Line {
    std::int64_t first, across, down;  // at the first pixel of the row; from pixel to pixel; from row to row
  };
  std::array<Line, 3> line_;
  PixelSpan box_;
};

// Depths of a triangle at one sample along a row: those of DepthPlane::at, bit for bit.
template <std::floating_point R>
struct RowDepths {
  R start, dx, part, least, greatest;
  std::int32_t first;  // whole pixels from the anchor to pixel 0

  RowDepths(const DepthPlane<R>& p, int x0, int y, int ox, int oy)
      : start(p.z + p.dy * (p.whole_px(y, p.anchor.y) + p.fraction_px(oy, p.anchor.y))),
        dx(p.dx),
        part(p.fraction_px(ox, p.anchor.x)),
        least(p.least),
        greatest(p.greatest),
        first(x0 - (p.anchor.x >> corner_bits)) {}
  R operator[](int x) const {
    R depth = start + dx * (static_cast<R>(first + x) + part);
    depth = depth < least ? least : depth;
    return depth > greatest ? greatest : depth;
  }
};

// What is done to whole rows; simd/fragment_layers.cpp has the same by vectors.
struct FragmentRows {
  template <std::floating_point R>
  static void depths(const RowDepths<R>& depth, PixelSpan span, R* out) {
    for (int x = span.x0; x < span.x1; ++x) out[x - span.x0] = depth[x];
  }
  // Puts a face between the fragments of each pixel of the span: behind what is nearer or as near, in front of the
  // rest. Where every layer is taken, the farthest makes room. Leaves out what is not in front of the cut; a face that
  // hides moves it.
  //   depth  by pixel, as RowDepths has it; infinite where the face is not
  template <std::floating_point R, class Depths>
  static void insert(const FragmentRow<R>& row, PixelSpan span, const Depths& depth, std::uint32_t face,
                     bool hides) {
    const int last = row.layers - 1;
    for (int x = span.x0; x < span.x1; ++x) {
      const R mine = depth[x];
      std::uint32_t* id = row.id + x;
      R* z = row.z + x;
      if (!(mine < z[last * row.z_stride]) || (row.cut != nullptr && !(mine < row.cut[x]))) continue;
      int layer = std::min(static_cast<int>(row.count[x]), last);
      row.count[x] = std::min(row.count[x] + 1, static_cast<std::uint32_t>(row.layers));
      if (hides) row.cut[x] = mine;
      for (; layer > 0 && mine < z[(layer - 1) * row.z_stride]; --layer) {
        z[layer * row.z_stride] = z[(layer - 1) * row.z_stride];
        id[layer * row.id_stride] = id[(layer - 1) * row.id_stride];
      }
      z[layer * row.z_stride] = mine;
      id[layer * row.id_stride] = face;
    }
  }
  // Leaves what is farther than `cut` (null: nothing) and gives depths their sign back.
  template <std::floating_point R>
  static void finish(const R* cut, R sign, R far, int n, std::uint32_t* id, R* z) {
    for (int i = 0; i < n; ++i) {
      if (cut != nullptr && z[i] > cut[i]) id[i] = no_face;
      z[i] = id[i] == no_face ? far : sign * z[i];
    }
  }
};

// Depths of a triangle at a row of `box`, whose samples lie elsewhere from pixel to pixel: infinite where they are not
// covered. Tells whether any is.
template <std::floating_point R>
bool varying_depths(const ScreenTriangle<R>& t, const SamplePositions& pattern, int sample, int y,
                    const PixelRect& box, R* depth) {
  bool any = false;
  for (int x = box.x0; x < box.x1; ++x) {
    const std::size_t i = pattern.index(sample, x, y);
    const std::int32_t ox = pattern.x[i], oy = pattern.y[i];
    const auto inside = [&](const Edge& e) { return Edge::covers(e.at_pixel(x, y), e.at_offset(ox, oy)); };
    const bool covered = inside(t.edge[0]) && inside(t.edge[1]) && inside(t.edge[2]);
    depth[x - box.x0] = covered ? t.depth.at(x, y, ox, oy) : std::numeric_limits<R>::infinity();
    any = any || covered;
  }
  return any;
}

}  // namespace frustum::kernels
