// Every triangle at every sample, from the nearest to the farthest: layers like those of a z-buffer, one behind
// the other.
#pragma once

#include "nodes/kernels/fill_triangles.h"

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

// Working memory of a rectangle. count and cut have a number a pixel, row and sample, the others one a pixel of a row.
template <std::floating_point R>
struct FragmentScratch {
  std::uint32_t* count;  // fragments so far
  R* cut;                // depth of the nearest face that hides; null where none does
  R* depth;
  std::uint32_t* moving;
};

struct FragmentCounts {
  std::uint32_t most = 0;       // fragments at one sample
  std::uint64_t fragments = 0;  // at all of them
  std::uint64_t beyond = 0;     // those farther back than the limit asked for
};

// Columns [x0, x1) of a row.
struct PixelSpan {
  int x0, x1;
  bool empty() const { return x0 >= x1; }
};

// Cuts a span to the pixels whose sample at (ox, oy) an edge holds inside. Exact: the edge function is linear in
// whole numbers. |result of at_pixel| < 2^61 and 2^16 steps of at most 2^38 stay within 64 bits.
inline PixelSpan cut_span(PixelSpan span, const Edge& e, int y, int ox, int oy) {
  const std::int64_t step = std::int64_t{e.a} * corner_unit;
  const std::int64_t first = e.at_pixel(span.x0, y) + e.at_offset(ox, oy);
  const std::int64_t last = first + (span.x1 - 1 - span.x0) * step;
  if (first >= 0 && last >= 0) return span;
  if (first < 0 && last < 0) return {span.x0, span.x0};
  if (first < 0) return {span.x0 + static_cast<int>((step - 1 - first) / step), span.x1};
  return {span.x0, span.x0 + static_cast<int>(first / -step) + 1};
}

// What is done to whole rows; simd/fragment_layers.cpp has the same by vectors.
struct FragmentRows {
  // Depths of a triangle at the sample (ox, oy) of n pixels from (x, y) on.
  template <std::floating_point R>
  static void depths(const DepthPlane<R>& plane, int x, int y, int ox, int oy, int n, R* out) {
    for (int i = 0; i < n; ++i) out[i] = plane.at(x + i, y, ox, oy);
  }
  // Fragments nearer than `limit` move: 1, the others 0. Counts those that do, up to `most`, and gives the
  // greatest count from before.
  template <std::floating_point R>
  static std::uint32_t begin(const R* depth, const R* limit, std::uint32_t most, int n, std::uint32_t* moving,
                             std::uint32_t* count) {
    std::uint32_t top = 0;
    for (int i = 0; i < n; ++i) {
      moving[i] = depth[i] < limit[i] ? 1 : 0;
      top = std::max(top, count[i]);
      count[i] = std::min(count[i] + moving[i], most);
    }
    return top;
  }
  // One step of an insertion sort from the back: where the fragment is nearer than what is in front, that takes
  // the place here and the fragment moves on; else the fragment takes it. Tells whether any moves on.
  template <std::floating_point R>
  static bool step(const R* depth, std::uint32_t face, int n, std::uint32_t* moving,
                   const std::uint32_t* id_front, const R* z_front, std::uint32_t* id, R* z) {
    std::uint32_t any = 0;
    for (int i = 0; i < n; ++i) {
      const bool on = moving[i] != 0, further = on && depth[i] < z_front[i];
      z[i] = further ? z_front[i] : on ? depth[i] : z[i];
      id[i] = further ? id_front[i] : on ? face : id[i];
      moving[i] = further ? 1 : 0;
      any |= moving[i];
    }
    return any != 0;
  }
  // The first layer takes what has come this far.
  template <std::floating_point R>
  static void place(const R* depth, std::uint32_t face, int n, const std::uint32_t* moving, std::uint32_t* id,
                    R* z) {
    for (int i = 0; i < n; ++i) {
      z[i] = moving[i] != 0 ? depth[i] : z[i];
      id[i] = moving[i] != 0 ? face : id[i];
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

// Where the triangle may cover one sample of a row of `box`, and its depths there: infinite where it does not.
// A pattern that repeats in every pixel makes the span exact, others are tested pixel by pixel.
template <std::floating_point R, class Rows>
PixelSpan cover_row(const ScreenTriangle<R>& t, const SamplePositions& pattern, int sample, int y,
                    const PixelRect& box, R* depth) {
  PixelSpan span{box.x0, box.x1};
  if (pattern.period == 1) {
    const int ox = pattern.x[static_cast<std::size_t>(sample)],
              oy = pattern.y[static_cast<std::size_t>(sample)];
    for (const Edge& e : t.edge) {
      span = cut_span(span, e, y, ox, oy);
      if (span.empty()) return span;
    }
    Rows::template depths<R>(t.depth, span.x0, y, ox, oy, span.x1 - span.x0, depth);
    return span;
  }
  bool any = false;
  for (int x = span.x0; x < span.x1; ++x) {
    const std::size_t i = pattern.index(sample, x, y);
    const std::int32_t ox = pattern.x[i], oy = pattern.y[i];
    const auto inside = [&](const Edge& e) { return Edge::covers(e.at_pixel(x, y), e.at_offset(ox, oy)); };
    const bool covered = inside(t.edge[0]) && inside(t.edge[1]) && inside(t.edge[2]);
    depth[x - span.x0] = covered ? t.depth.at(x, y, ox, oy) : std::numeric_limits<R>::infinity();
    any = any || covered;
  }
  return any ? span : PixelSpan{span.x0, span.x0};
}

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
      Rows::template finish<R>(s_.cut == nullptr ? nullptr : s_.cut + row_of(sample, y), scene_.fill.sign(),
                               scene_.fill.far(), width_, id_row(layer, sample, y), z_row(layer, sample, y));
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

  void draw(const ScreenTriangle<R>& t, std::uint32_t face, const PixelRect& box) const {
    for (int sample = 0; sample < pattern_.samples; ++sample)
      for (int y = box.y0; y < box.y1; ++y) {
        const PixelSpan span = cover_row<R, Rows>(t, pattern_, sample, y, box, s_.depth);
        if (!span.empty()) insert(sample, y - rect_.y0, span, face);
      }
  }

  // Entries come in ascending (origin, face), and a fragment stops behind what is as near as it: equal depths
  // stay in that order. Of a face that hides, only what is drawn before it and as near stays in front.
  void insert(int sample, int y, PixelSpan span, std::uint32_t face) const {
    const int x = span.x0 - rect_.x0, n = span.x1 - span.x0;
    const std::ptrdiff_t at = row_of(sample, y) + x;
    const int last = to_.layers - 1;
    // Where every layer is taken, the farthest fragment makes room, if it is farther than the new one.
    const R* limit = z_row(last, sample, y) + x;
    if (s_.cut != nullptr) limit = lesser(limit, s_.cut + at, n);
    const std::uint32_t top = Rows::template begin<R>(s_.depth, limit, static_cast<std::uint32_t>(to_.layers),
                                                      n, s_.moving, s_.count + at);
    if (scene_.hides_at(face)) hide(s_.cut + at, n);
    for (int layer = std::min(static_cast<int>(top), last); layer > 0; --layer)
      if (!Rows::template step<R>(s_.depth, face, n, s_.moving, id_row(layer - 1, sample, y) + x,
                                  z_row(layer - 1, sample, y) + x, id_row(layer, sample, y) + x,
                                  z_row(layer, sample, y) + x))
        return;
    Rows::template place<R>(s_.depth, face, n, s_.moving, id_row(0, sample, y) + x, z_row(0, sample, y) + x);
  }

  // Both limits in one row of scratch.
  const R* lesser(const R* a, const R* b, int n) const {
    R* out = s_.depth + width_;
    for (int i = 0; i < n; ++i) out[i] = a[i] < b[i] ? a[i] : b[i];
    return out;
  }
  void hide(R* cut, int n) const {
    for (int i = 0; i < n; ++i)
      if (s_.moving[i] != 0) cut[i] = s_.depth[i];
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
//   scratch  depth holds two rows
// A pure function of (x, y, sample): the bytes do not depend on rect; layer 0 has those of fill_triangles. Cost:
// O(entries + covered samples * layers that a fragment moves past + pixels * samples * layers).
// This is the truth that simd/fragment_layers.h is held against.
template <std::floating_point R, class Rows = FragmentRows>
void fill_fragments(const FragmentScene<R>& scene, PixelRect rect, const FragmentLayers<R>& to,
                    const FragmentScratch<R>& scratch) {
  detail::FragmentFiller<R, Rows>(scene, rect, to, scratch).fill();
}

// Counts the fragments of one bin, as fill_fragments leaves them where there are layers enough; `limit` is that of
// FragmentCounts::beyond. Memory: 16 samples of the bin at a time.
template <std::floating_point R, class Rows = FragmentRows>
FragmentCounts count_fragments(const FragmentScene<R>& scene, int column, int row, std::uint32_t limit) {
  constexpr int size = TriangleBins::size, chunk = 16;
  constexpr std::size_t area = std::size_t{size} * size;
  const TriangleBins& bins = *scene.fill.bins;
  const SamplePositions& pattern = scene.fill.pattern;
  const std::span<const BinEntry> entries = bins.bin(column, row);
  const glm::ivec2 corner(bins.window.x0 + column * size, bins.window.y0 + row * size);
  const PixelRect part = intersection(bins.window, {corner.x, corner.y, corner.x + size, corner.y + size});
  FragmentCounts sum;
  std::vector<std::uint32_t> count(area * chunk), rank;
  std::vector<R> cut, depth(static_cast<std::size_t>(size));
  if (!scene.hides.empty()) rank.resize(area * chunk), cut.resize(area * chunk);
  for (int first = 0; first < pattern.samples; first += chunk) {
    const int end = std::min(first + chunk, pattern.samples);
    // Calls body(place of the row's first pixel, its number of pixels, number of the entry).
    const auto for_spans = [&](bool hiding, const auto& body) {
      for (std::size_t i = 0; i < entries.size(); ++i) {
        const BinEntry& e = entries[i];
        const PixelRect box = box_in(part, corner, e);
        if (box.empty() || (hiding && !scene.hides_at(e.face))) continue;
        const auto t = *screen_triangle(scene.fill.mesh, e.face, scene.fill.sign());
        for (int s = first; s < end; ++s)
          for (int y = box.y0; y < box.y1; ++y) {
            const PixelSpan span = cover_row<R, Rows>(t, pattern, s, y, box, depth.data());
            const auto at =
                static_cast<std::size_t>(((s - first) * size + y - corner.y) * size + span.x0 - corner.x);
            body(at, static_cast<std::size_t>(span.x1 - span.x0), static_cast<std::uint32_t>(i));
          }
      }
    };
    std::fill(count.begin(), count.end(), 0u);
    std::fill(cut.begin(), cut.end(), std::numeric_limits<R>::infinity());
    if (!cut.empty())
      for_spans(true, [&](std::size_t at, std::size_t n, std::uint32_t i) {
        for (std::size_t x = 0; x < n; ++x)
          if (depth[x] < cut[at + x]) cut[at + x] = depth[x], rank[at + x] = i;
      });
    for_spans(false, [&](std::size_t at, std::size_t n, std::uint32_t i) {
      if (cut.empty() && pattern.period == 1)
        for (std::size_t x = 0; x < n; ++x) ++count[at + x];
      else if (cut.empty())
        for (std::size_t x = 0; x < n; ++x)
          count[at + x] += depth[x] < std::numeric_limits<R>::infinity() ? 1 : 0;
      else
        for (std::size_t x = 0; x < n; ++x)
          count[at + x] += depth[x] < cut[at + x] || (depth[x] == cut[at + x] && i <= rank[at + x] &&
                                                      depth[x] < std::numeric_limits<R>::infinity())
                               ? 1
                               : 0;
    });
    for (const std::uint32_t n : count) {
      sum.most = std::max(sum.most, n);
      sum.fragments += n;
      sum.beyond += n > limit ? n - limit : 0;
    }
  }
  return sum;
}

}  // namespace frustum::kernels
