// Every triangle at every sample, from the nearest to the farthest: layers like those of a z-buffer, one behind
// the other.
#pragma once

#include "nodes/kernels/fragment_rows.h"

namespace frustum::kernels {

// What the layers are made of. `hides` says by face whether nothing behind it shows; empty: none hides.
template <std::floating_point R>
struct FragmentScene {
  FillScene<R> fill;
  std::span<const std::uint8_t> hides;

  bool hides_at(std::uint32_t face) const { return !hides.empty() && hides[face] != 0; }
};

// Layer l of sample s is sample l * samples + s of both planes.
template <std::floating_point R>
struct FragmentLayers {
  PlaneView<std::uint32_t> id;
  PlaneView<R> z;
  int layers;
};

// Working memory of a rectangle. count and cut have a number a pixel, row and sample, depth one a pixel of a row.
template <std::floating_point R>
struct FragmentScratch {
  std::uint32_t* count;  // fragments so far
  R* cut;                // depth of the nearest face that hides; null where none does
  R* depth;
};

namespace detail {

// Fills one rectangle; see fill_fragments.
template <std::floating_point R, class Rows>
class FragmentFiller {
 public:
  FragmentFiller(const FragmentScene<R>& scene, PixelRect rect, const FragmentLayers<R>& to,
                 const FragmentScratch<R>& scratch)
      : scene_(scene),
        pattern_(scene.fill.pattern),
        rect_(rect),
        to_(to),
        s_(scratch),
        width_(rect.x1 - rect.x0),
        height_(rect.y1 - rect.y0) {}

  void fill() {
    clear();
    each_bin_of(*scene_.fill.bins, rect_,
                [&](PixelRect part, glm::ivec2 corner, std::span<const BinEntry> entries) {
                  for (const BinEntry& e : entries) {
                    const PixelRect box = box_in(part, corner, e);
                    if (!box.empty())
                      draw(*screen_triangle(scene_.fill.mesh, e.face, scene_.fill.sign()), e.face, box);
                  }
                });
    for_rows(to_.layers, [&](int layer, int sample, int y) {
      Rows::finish(s_.cut == nullptr ? static_cast<const R*>(nullptr) : s_.cut + row_of(sample, y),
                   scene_.fill.sign(), scene_.fill.far(), width_, id_row(layer, sample, y),
                   z_row(layer, sample, y));
    });
  }

 private:
  static constexpr R beyond_all = std::numeric_limits<R>::infinity();

  template <class Body>
  void for_rows(int layers, const Body& body) const {
    for (int layer = 0; layer < layers; ++layer)
      for (int sample = 0; sample < pattern_.samples; ++sample)
        for (int y = 0; y < height_; ++y) body(layer, sample, y);
  }
  std::uint32_t* id_row(int layer, int sample, int y) const {
    return to_.id.row(layer * pattern_.samples + sample, y);
  }
  R* z_row(int layer, int sample, int y) const { return to_.z.row(layer * pattern_.samples + sample, y); }
  std::ptrdiff_t row_of(int sample, int y) const { return (std::ptrdiff_t{sample} * height_ + y) * width_; }

  void clear() const {
    for_rows(to_.layers, [&](int layer, int sample, int y) {
      std::fill_n(id_row(layer, sample, y), width_, no_face);
      std::fill_n(z_row(layer, sample, y), width_, beyond_all);
    });
    std::fill_n(s_.count, row_of(pattern_.samples, 0), 0u);
    if (s_.cut != nullptr) std::fill_n(s_.cut, row_of(pattern_.samples, 0), beyond_all);
  }

  FragmentRow<R> row(int sample, int y) const {
    const std::ptrdiff_t at = row_of(sample, y);
    return {id_row(0, sample, y),
            z_row(0, sample, y),
            to_.id.sample_stride * pattern_.samples,
            to_.z.sample_stride * pattern_.samples,
            s_.count + at,
            s_.cut == nullptr ? nullptr : s_.cut + at,
            width_,
            to_.layers};
  }

  // Entries come in ascending (origin, face), and a fragment stops behind what is as near as it: equal depths
  // stay in that order. Of a face that hides, only what is drawn before it and as near stays in front.
  void draw(const ScreenTriangle<R>& t, std::uint32_t face, const PixelRect& box) const {
    const bool hides = scene_.hides_at(face);
    for (int sample = 0; sample < pattern_.samples; ++sample) {
      if (pattern_.period != 1) {
        draw_varying(t, face, box, sample, hides);
        continue;
      }
      const int ox = pattern_.x[static_cast<std::size_t>(sample)],
                oy = pattern_.y[static_cast<std::size_t>(sample)];
      RowSpans spans(t.edge, ox, oy, box);
      for (int y = box.y0; y < box.y1; ++y) {
        const PixelSpan span = spans.next();
        if (!span.empty())
          Rows::insert(row(sample, y - rect_.y0), PixelSpan{span.x0 - rect_.x0, span.x1 - rect_.x0},
                       RowDepths<R>(t.depth, rect_.x0, y, ox, oy), face, hides);
      }
    }
  }

  void draw_varying(const ScreenTriangle<R>& t, std::uint32_t face, const PixelRect& box, int sample,
                    bool hides) const {
    const PixelSpan span{box.x0 - rect_.x0, box.x1 - rect_.x0};
    for (int y = box.y0; y < box.y1; ++y)
      if (varying_depths(t, pattern_, sample, y, box, s_.depth + span.x0))
        Rows::insert(row(sample, y - rect_.y0), span, static_cast<const R*>(s_.depth), face, hides);
  }

  const FragmentScene<R>& scene_;
  const SamplePositions& pattern_;
  const PixelRect rect_;
  const FragmentLayers<R>& to_;
  const FragmentScratch<R>& s_;
  const int width_, height_;
};

}  // namespace detail

// Fills the layers of `rect` with the fragments of every sample, nearest first, in the total order (depth, origin,
// face); behind them no_face and the far depth. Where there are more than layers, the nearest stay. A fragment
// farther than a face that hides, or as far and later in the order, is left out.
//   rect     absolute pixels within the window of the bins; any size and alignment
// A pure function of (x, y, sample): the bytes do not depend on rect; layer 0 has those of fill_triangles. Cost:
// O(entries + covered samples * layers that a fragment moves past + pixels * samples * layers).
// This is the truth that simd/fragment_layers.h is held against.
template <std::floating_point R, class Rows = FragmentRows>
void fill_fragments(const FragmentScene<R>& scene, PixelRect rect, const FragmentLayers<R>& to,
                    const FragmentScratch<R>& scratch) {
  detail::FragmentFiller<R, Rows>(scene, rect, to, scratch).fill();
}

}  // namespace frustum::kernels
