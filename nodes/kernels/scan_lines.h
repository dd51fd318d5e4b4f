// Scanline visibility: line by line, the faces that the line meets give spans, and spans are compared only where
// they overlap.
// Source: Watkins 1970, A Real Time Visible Surface Algorithm, University of Utah UTEC-CSc-70-101: spans whose
// order is not clear from their ends are halved. Departures: a line for each sample of a pixel; a span's order is
// clear only where rounding cannot turn it, so the picture is that of the depth buffer at every sample.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/face_depth.h"
#include "nodes/kernels/fill_triangles.h"

namespace frustum::scanline {

using kernels::PixelRect;
using kernels::PlaneView;

// The work of some lines.
struct Counts {
  std::uint64_t lines = 0, edges = 0, spans = 0, segments = 0, comparisons = 0, halvings = 0, most_active = 0;
};

// A stretch of a line in which nothing begins and nothing ends.
struct Segment {
  int row, sample;
  int begin, end;             // pixels, the end excluded
  std::uint32_t active;       // spans that cover it
  std::uint32_t comparisons;  // of depths, until all of it was decided
  std::uint32_t face;         // seen at its begin
};

// Calls to watch a line at work; both may be empty.
struct Watch {
  Counts* counts = nullptr;
  std::function<void(const Segment&)> segment = {};
};

template <std::floating_point R>
class Scanner {
 public:
  //   claim  called with bytes of memory before they are taken; may throw
  Scanner(const kernels::ScreenMesh<R>& mesh, const kernels::SamplePositions& pattern, PixelRect window,
          kernels::DepthOrder depths, const std::function<void(std::uint64_t)>& claim)
      : scene_{mesh, pattern, nullptr, depths}, bins_(kernels::bin_triangles(mesh, pattern, window, claim)) {}

  const kernels::TriangleBins& bins() const { return bins_; }
  int samples() const { return scene_.pattern.samples; }

  // Fills `id` and `z` as fill_triangles does, the same bytes. Memory beyond the planes: the edges of the faces
  // that meet `rect`, and O(width) for the spans of one line.
  void fill(PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z, const Watch& watch = {}) const;

 private:
  struct Face {
    kernels::ScreenTriangle<R> triangle;
    std::uint32_t index, origin;
    PixelRect box;        // pixels that it may cover
    mutable R band = -1;  // of its depth, found when two spans are first compared: see band_of
  };
  struct Span {
    const Face* face;
    int begin, end;
  };
  // One line: row y of a sample, and of each `period` pixels one, since those have the sample at one height.
  struct Line {
    int sample, y, phase, period;
    std::int32_t x, dy;  // the sample's offset in its pixel
    std::uint32_t* id;   // of pixel 0
    R* z;
  };

  std::vector<Face> faces_of(PixelRect rect) const;
  std::vector<const Face*> by_first_row(const std::vector<Face>& faces, PixelRect rect) const;
  R band_of(const Face& f) const;
  bool cross(const Face& f, const Line& line, Span& out) const;
  bool cross_narrow(const Face& f, const Line& line, Span& out) const;
  void sweep(std::vector<Span>& spans, const Line& line, const Watch& watch) const;
  void decide(std::vector<const Face*>& active, std::size_t from, int begin, int end, const Line& line,
              Segment& seen, const Watch& watch) const;
  void show(const Face& f, int begin, int end, const Line& line) const;

  static R depth(const Face& f, int x, const Line& line) {
    return f.triangle.depth.at(x, line.y, line.x, line.dy);
  }
  // Nearer, of the same depth the lower source.
  static bool nearer(const Face& a, R za, const Face& b, R zb) {
    if (za != zb) return za < zb;
    return std::pair(a.origin, a.index) < std::pair(b.origin, b.index);
  }

  kernels::FillScene<R> scene_;
  kernels::TriangleBins bins_;
};

namespace detail {

// a / b, rounded towards minus infinity; b > 0.
inline std::int64_t floor_div(std::int64_t a, std::int64_t b) {
  const std::int64_t q = a / b;
  return q - (a % b < 0 ? 1 : 0);
}

}  // namespace detail

// The faces of a rectangle, by their number.
template <std::floating_point R>
auto Scanner<R>::faces_of(PixelRect rect) const -> std::vector<Face> {
  std::vector<std::pair<std::uint32_t, PixelRect>> parts;
  kernels::each_bin_of(bins_, rect,
                       [&](PixelRect part, glm::ivec2 corner, std::span<const kernels::BinEntry> entries) {
                         for (const kernels::BinEntry& e : entries)
                           if (const PixelRect box = kernels::box_in(part, corner, e); !box.empty())
                             parts.emplace_back(e.face, box);
                       });
  std::sort(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Face> faces;
  faces.reserve(parts.size());
  for (const auto& [index, box] : parts) {
    if (!faces.empty() && faces.back().index == index) {
      PixelRect& all = faces.back().box;
      all = {std::min(all.x0, box.x0), std::min(all.y0, box.y0), std::max(all.x1, box.x1),
             std::max(all.y1, box.y1)};
    } else if (const auto t = kernels::screen_triangle(scene_.mesh, index, scene_.sign())) {
      faces.push_back({*t, index, scene_.mesh.origin.empty() ? index : scene_.mesh.origin[index], box});
    }
  }
  return faces;
}

// The edge table: those that begin in one row stand together, in the order of their numbers.
template <std::floating_point R>
auto Scanner<R>::by_first_row(const std::vector<Face>& faces, PixelRect rect) const
    -> std::vector<const Face*> {
  std::vector<std::size_t> at(static_cast<std::size_t>(rect.y1 - rect.y0) + 1, 0);
  const auto row = [&](const Face& f) { return static_cast<std::size_t>(f.box.y0 - rect.y0); };
  for (const Face& f : faces) ++at[row(f) + 1];
  for (std::size_t y = 1; y < at.size(); ++y) at[y] += at[y - 1];
  std::vector<const Face*> order(faces.size());
  for (const Face& f : faces) order[at[row(f)]++] = &f;
  return order;
}

template <std::floating_point R>
R Scanner<R>::band_of(const Face& f) const {
  if (f.band < 0)
    f.band =
        static_cast<R>(kernels::screen_face(scene_.mesh, f.index, scene_.sign()).depth.band * (1 + 0x1p-20));
  return f.band;
}

// The pixels on the line whose samples the face covers: where all three edge functions, each linear along the line
// and exact in whole numbers, are not negative. Narrow faces are tried pixel by pixel: a division is dearer.
template <std::floating_point R>
bool Scanner<R>::cross(const Face& f, const Line& line, Span& out) const {
  constexpr int narrow = 4;
  if (f.box.x1 - f.box.x0 <= narrow) return cross_narrow(f, line, out);
  std::int64_t begin = f.box.x0, end = f.box.x1;
  for (const kernels::Edge& e : f.triangle.edge) {
    const std::int64_t at0 = e.at_pixel(0, line.y) + e.at_offset(line.x, line.dy);
    const std::int64_t slope = std::int64_t{e.a} * kernels::corner_unit;
    if (slope > 0)
      begin = std::max(begin, -detail::floor_div(at0, slope));
    else if (slope < 0)
      end = std::min(end, detail::floor_div(at0, -slope) + 1);
    else if (at0 < 0)
      return false;
  }
  // The first pixel of the line's own phase at or right of `begin`.
  begin += (line.phase - begin % line.period + line.period) % line.period;
  out = {&f, static_cast<int>(begin), static_cast<int>(end)};
  return begin < end;
}

template <std::floating_point R>
bool Scanner<R>::cross_narrow(const Face& f, const Line& line, Span& out) const {
  const auto covers = [&](int x) {
    for (const kernels::Edge& e : f.triangle.edge)
      if (!kernels::Edge::covers(e.at_pixel(x, line.y), e.at_offset(line.x, line.dy))) return false;
    return true;
  };
  int x = f.box.x0 + (line.phase - f.box.x0 % line.period + line.period) % line.period;
  while (x < f.box.x1 && !covers(x)) x += line.period;
  out = {&f, x, x};
  for (; x < f.box.x1 && covers(x); x += line.period) out.end = x + 1;
  return out.begin < out.end;
}

template <std::floating_point R>
void Scanner<R>::show(const Face& f, int begin, int end, const Line& line) const {
  for (int x = begin; x < end; x += line.period) {
    line.id[x] = f.index;
    line.z[x] = scene_.sign() * depth(f, x, line);
  }
}

// Shows active[from ..] in [begin, end), all of which cover it. Whoever is nearest at both ends, by more than
// rounding, is nearest between them, since depths are linear; where that is nobody, the stretch is halved.
template <std::floating_point R>
void Scanner<R>::decide(std::vector<const Face*>& active, std::size_t from, int begin, int end,
                        const Line& line, Segment& seen, const Watch& watch) const {
  const int pixels = (end - begin + line.period - 1) / line.period, last = begin + (pixels - 1) * line.period;
  const auto nearest_at = [&](int x) {
    const Face* best = active[from];
    R z = depth(*best, x, line);
    for (std::size_t i = from + 1; i < active.size(); ++i) {
      const R other = depth(*active[i], x, line);
      ++seen.comparisons;
      if (nearer(*active[i], other, *best, z)) best = active[i], z = other;
    }
    return std::pair(best, z);
  };
  constexpr int brief = 4;  // pixels: to try each of them is as dear as both ends twice
  if (pixels <= brief) {
    for (int x = begin; x < end; x += line.period) show(*nearest_at(x).first, x, x + 1, line);
    return;
  }
  const auto [best, z_begin] = nearest_at(begin);
  const auto [at_last, z_last] = nearest_at(last);
  const std::size_t rivals = active.size();
  for (std::size_t i = from; i < rivals; ++i) {
    const Face* f = active[i];
    const auto clear = [&, best = best](R z, int x) {
      return depth(*f, x, line) - z > band_of(*f) + band_of(*best);
    };
    if (f != best && !(clear(z_begin, begin) && clear(depth(*best, last, line), last))) active.push_back(f);
  }
  if (active.size() == rivals && best == at_last) return show(*best, begin, end, line);
  active.push_back(best);
  const int middle = begin + pixels / 2 * line.period;
  if (watch.counts != nullptr) ++watch.counts->halvings;
  const std::size_t contenders = active.size();
  decide(active, rivals, begin, middle, line, seen, watch);
  active.resize(contenders);
  decide(active, rivals, middle, end, line, seen, watch);
  active.resize(rivals);
}

// Moves along the line from one begin or end of a span to the next.
template <std::floating_point R>
void Scanner<R>::sweep(std::vector<Span>& spans, const Line& line, const Watch& watch) const {
  std::sort(spans.begin(), spans.end(), [](const Span& a, const Span& b) {
    return std::pair(a.begin, a.face->index) < std::pair(b.begin, b.face->index);
  });
  std::vector<Span> active;
  std::vector<const Face*> here;
  std::size_t next = 0;
  for (int x = 0; next < spans.size() || !active.empty();) {
    if (active.empty()) x = spans[next].begin;
    while (next < spans.size() && spans[next].begin <= x) active.push_back(spans[next++]);
    int end = next < spans.size() ? spans[next].begin : active.front().end;
    for (const Span& s : active) end = std::min(end, s.end);
    end = x + (end - x + line.period - 1) / line.period * line.period;  // a pixel of the line's own
    here.clear();
    for (const Span& s : active) here.push_back(s.face);
    Segment seen{line.y, line.sample, x, end, static_cast<std::uint32_t>(here.size()), 0, 0};
    decide(here, 0, x, end, line, seen, watch);
    if (watch.counts != nullptr) {
      ++watch.counts->segments;
      watch.counts->comparisons += seen.comparisons;
      watch.counts->most_active = std::max<std::uint64_t>(watch.counts->most_active, active.size());
    }
    seen.face = line.id[x];
    if (watch.segment) watch.segment(seen);
    x = end;
    std::erase_if(active, [&](const Span& s) { return s.end <= x; });
  }
}

template <std::floating_point R>
void Scanner<R>::fill(PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z, const Watch& watch) const {
  const std::vector<Face> faces = faces_of(rect);
  const std::vector<const Face*> edge_table = by_first_row(faces, rect);
  const kernels::SamplePositions& pattern = scene_.pattern;
  std::vector<const Face*> active;
  std::vector<Span> spans;
  std::size_t next = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (; next < edge_table.size() && edge_table[next]->box.y0 <= y; ++next)
      active.push_back(edge_table[next]);
    std::erase_if(active, [&](const Face* f) { return f->box.y1 <= y; });
    for (int s = 0; s < pattern.samples; ++s) {
      std::uint32_t* id_row = id.row(s, y - rect.y0);
      R* z_row = z.row(s, y - rect.y0);
      std::fill_n(id_row, rect.x1 - rect.x0, kernels::no_face);
      std::fill_n(z_row, rect.x1 - rect.x0, scene_.far());
      for (int phase = 0; phase < pattern.period; ++phase) {
        const std::size_t i = pattern.index(s, phase, y);
        const Line line{
            s, y, phase, pattern.period, pattern.x[i], pattern.y[i], id_row - rect.x0, z_row - rect.x0};
        spans.clear();
        for (const Face* f : active)
          if (Span span; cross(*f, line, span)) spans.push_back(span);
        if (watch.counts != nullptr) {
          ++watch.counts->lines;
          watch.counts->edges += 3 * active.size();
          watch.counts->spans += spans.size();
        }
        sweep(spans, line, watch);
      }
    }
  }
}

}  // namespace frustum::scanline
