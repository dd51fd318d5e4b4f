// Scanline visibility: line by line, the faces that the line meets give spans, and spans are compared only where
// they overlap.
// Source: Watkins 1970, A Real Time Visible Surface Algorithm, University of Utah UTEC-CSc-70-101: spans whose
// order is not clear from their ends are halved. Departures: a line for each sample of a pixel; a span's order is
// clear only where rounding cannot turn it, so the picture is that of the depth buffer at every sample; a span that
// begins behind one that outlasts it is left out at once.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/face_depth.h"
#include "nodes/kernels/fragment_rows.h"

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
  std::uint32_t active;       // spans that cover it, but for those known to lie behind another of them
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

  // Fills `id` and `z` as fill_triangles does, the same bytes. Memory beyond the planes: the numbers and boxes of the
  // faces that meet `rect`, the edges of those that meet one line, and O(width) for its spans.
  void fill(PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z, const Watch& watch = {}) const;

 private:
  struct Part {  // a face in the rectangle
    std::uint32_t face;
    PixelRect box;  // pixels that it may cover
  };
  struct Face {
    kernels::ScreenTriangle<R> triangle;
    std::uint32_t index, origin;
    PixelRect box;
    mutable R band = -1;  // of its depth, found when two spans are first compared: see band_of
  };
  // Its depths lie within those of its face's corners, so that two spans may be in order wherever they overlap.
  struct Span {
    const Face* face;
    const Span* next;  // that begins at the same pixel
    int begin, end;
    kernels::RowDepths<R> depth;

    bool behind(const Span& other) const { return depth.least > other.depth.greatest; }
  };
  // One line: row y of a sample, and of each `period` pixels one, since those have the sample at one height.
  struct Line {
    int sample, y, phase, period;
    std::int32_t x, dy;  // the sample's offset in its pixel
    std::uint32_t* id;   // of pixel 0
    R* z;
  };

  // What a line works with. A line has no more spans than faces, so that places in `spans` stay.
  struct Work {
    std::vector<Span> spans = {};
    std::vector<const Span*> first;  // by pixel the last made span that begins there, or null
    std::vector<const Span*> active = {},
                             here = {};  // spans that go on; those that a segment is decided among
    std::uint32_t comparisons = 0;       // since the last segment
    int x0;                              // pixel of first[0]

    const Span*& first_at(int x) { return first[static_cast<std::size_t>(x - x0)]; }
    int end() const { return x0 + static_cast<int>(first.size()); }
  };

  // The faces that meet a row. Those that end leave their place to others, so that all stay in the cache.
  struct Active {
    std::vector<Face> faces = {};
    std::vector<std::uint32_t> now = {}, free = {};  // places of `faces`
  };

  std::vector<Part> parts_of(PixelRect rect) const;
  static std::vector<Part> by_first_row(const std::vector<Part>& parts, PixelRect rect);
  void begin_face(const Part& part, Active& active) const;
  R band_of(const Face& f) const;
  static kernels::PixelSpan cross(const Face& f, const Line& line);
  static void find_spans(const Active& active, const Line& line, Work& work);
  void sweep(Work& work, const Line& line, const Watch& watch) const;
  static bool hidden(const Span& s, Work& work);
  static void enter(int x, Work& work);
  static int next_begin(int x, int end, Work& work);
  static void choose_rivals(Work& work);
  void decide(std::vector<const Span*>& active, std::size_t from, int begin, int end, const Line& line,
              Segment& seen, const Watch& watch) const;
  void show(const Span& s, int begin, int end, const Line& line) const;

  // Nearer, of the same depth the lower source.
  static bool nearer(const Face& a, R za, const Face& b, R zb) {
    if (za != zb) return za < zb;
    return std::pair(a.origin, a.index) < std::pair(b.origin, b.index);
  }

  kernels::FillScene<R> scene_;
  kernels::TriangleBins bins_;
};

// The faces of a rectangle. Those that touch no side of their bin are in no other; the parts of the rest are put
// together by their numbers.
template <std::floating_point R>
auto Scanner<R>::parts_of(PixelRect rect) const -> std::vector<Part> {
  constexpr int last = kernels::TriangleBins::size - 1;
  std::vector<Part> faces, pieces;
  kernels::each_bin_of(bins_, rect,
                       [&](PixelRect part, glm::ivec2 corner, std::span<const kernels::BinEntry> entries) {
                         for (const kernels::BinEntry& e : entries) {
                           const PixelRect box = kernels::box_in(part, corner, e);
                           if (box.empty()) continue;
                           const bool within = e.x0 > 0 && e.y0 > 0 && e.x1 < last && e.y1 < last;
                           (within ? faces : pieces).push_back({e.face, box});
                         }
                       });
  std::sort(pieces.begin(), pieces.end(), [](const Part& a, const Part& b) { return a.face < b.face; });
  for (std::size_t i = 0; i < pieces.size();) {
    Part all = pieces[i];
    for (++i; i < pieces.size() && pieces[i].face == all.face; ++i) {
      const PixelRect& box = pieces[i].box;
      all.box = {std::min(all.box.x0, box.x0), std::min(all.box.y0, box.y0), std::max(all.box.x1, box.x1),
                 std::max(all.box.y1, box.y1)};
    }
    faces.push_back(all);
  }
  return faces;
}

// The edge table: those that begin in one row stand together.
template <std::floating_point R>
auto Scanner<R>::by_first_row(const std::vector<Part>& parts, PixelRect rect) -> std::vector<Part> {
  std::vector<std::size_t> at(static_cast<std::size_t>(rect.y1 - rect.y0) + 1, 0);
  const auto row = [&](const Part& p) { return static_cast<std::size_t>(p.box.y0 - rect.y0); };
  for (const Part& p : parts) ++at[row(p) + 1];
  for (std::size_t y = 1; y < at.size(); ++y) at[y] += at[y - 1];
  std::vector<Part> order(parts.size());
  for (const Part& p : parts) order[at[row(p)]++] = p;
  return order;
}

template <std::floating_point R>
void Scanner<R>::begin_face(const Part& part, Active& active) const {
  const auto triangle = kernels::screen_triangle(scene_.mesh, part.face, scene_.sign());
  if (!triangle) return;
  if (active.free.empty()) {
    active.free.push_back(static_cast<std::uint32_t>(active.faces.size()));
    active.faces.emplace_back();
  }
  const std::uint32_t place = active.free.back();
  active.free.pop_back();
  active.faces[place] = {*triangle, part.face,
                         scene_.mesh.origin.empty() ? part.face : scene_.mesh.origin[part.face], part.box};
  active.now.push_back(place);
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
kernels::PixelSpan Scanner<R>::cross(const Face& f, const Line& line) {
  constexpr int narrow = 4;
  std::array<std::int64_t, 3> first, step;
  for (std::size_t k = 0; k < 3; ++k) {
    const kernels::Edge& e = f.triangle.edge[k];
    first[k] = e.at_pixel(f.box.x0, line.y) + e.at_offset(line.x, line.dy);
    step[k] = std::int64_t{e.a} * kernels::corner_unit;
  }
  kernels::PixelSpan span{f.box.x0, f.box.x1};
  if (span.x1 - span.x0 > narrow) {
    for (std::size_t k = 0; k < 3 && !span.empty(); ++k)
      span = kernels::cut_span(span, first[k] + (span.x0 - f.box.x0) * step[k], step[k]);
    return span;
  }
  const auto outside = [&] { return (first[0] | first[1] | first[2]) < 0; };
  const auto go_on = [&](int& x) {
    for (std::size_t k = 0; k < 3; ++k) first[k] += step[k];
    ++x;
  };
  while (span.x0 < f.box.x1 && outside()) go_on(span.x0);
  span.x1 = span.x0;
  while (span.x1 < f.box.x1 && !outside()) go_on(span.x1);
  return span;
}

template <std::floating_point R>
void Scanner<R>::find_spans(const Active& active, const Line& line, Work& work) {
  work.spans.clear();
  for (const std::uint32_t place : active.now) {
    const Face& f = active.faces[place];
    const kernels::PixelSpan span = cross(f, line);
    // The first pixel of the line's own phase at or right of its begin.
    const int begin = line.period == 1
                          ? span.x0
                          : span.x0 + (line.phase - span.x0 % line.period + line.period) % line.period;
    if (begin >= span.x1) continue;
    const Span*& first = work.first_at(begin);
    work.spans.push_back(
        {&f, first, begin, span.x1, kernels::RowDepths<R>(f.triangle.depth, 0, line.y, line.x, line.dy)});
    first = &work.spans.back();
  }
}

template <std::floating_point R>
void Scanner<R>::show(const Span& s, int begin, int end, const Line& line) const {
  if (line.period == 1) {
    const R sign = scene_.sign();
    for (int x = begin; x < end; ++x) line.id[x] = s.face->index;
    for (int x = begin; x < end; ++x) line.z[x] = sign * s.depth[x];
    return;
  }
  for (int x = begin; x < end; x += line.period) {
    line.id[x] = s.face->index;
    line.z[x] = scene_.sign() * s.depth[x];
  }
}

// Shows active[from ..] in [begin, end), all of which cover it. Whoever is nearest at both ends, by more than
// rounding, is nearest between them, since depths are linear; where that is nobody, the stretch is halved.
template <std::floating_point R>
void Scanner<R>::decide(std::vector<const Span*>& active, std::size_t from, int begin, int end,
                        const Line& line, Segment& seen, const Watch& watch) const {
  const std::size_t rivals = active.size();
  if (rivals == from + 1) return show(*active[from], begin, end, line);
  const int pixels = (end - begin + line.period - 1) / line.period, last = begin + (pixels - 1) * line.period;
  const auto nearest_at = [&](int x) {
    const Span* best = active[from];
    R z = best->depth[x];
    for (std::size_t i = from + 1; i < rivals; ++i) {
      const R other = active[i]->depth[x];
      ++seen.comparisons;
      if (nearer(*active[i]->face, other, *best->face, z)) best = active[i], z = other;
    }
    return std::pair(best, z);
  };
  constexpr int brief = 4;  // pixels: to try each of them is as dear as both ends twice
  if (pixels <= brief) {
    for (int x = begin; x < end; x += line.period) {
      const auto [best, z] = nearest_at(x);
      line.id[x] = best->face->index;
      line.z[x] = scene_.sign() * z;
    }
    return;
  }
  const auto [best, z_begin] = nearest_at(begin);
  const auto [at_last, z_last] = nearest_at(last);
  for (std::size_t i = from; i < rivals; ++i) {
    const Span* s = active[i];
    const auto clear = [&, best = best](R z, int x) {
      return s->depth[x] - z > band_of(*s->face) + band_of(*best->face);
    };
    if (s != best && !(clear(z_begin, begin) && clear(best->depth[last], last))) active.push_back(s);
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

// Whether an active span that goes on for as long is nearer all the way.
template <std::floating_point R>
bool Scanner<R>::hidden(const Span& s, Work& work) {
  for (const Span* other : work.active) {
    ++work.comparisons;
    if (other->end >= s.end && s.behind(*other)) return true;
  }
  return false;
}

// Takes up the spans that begin at x, and leaves out what one of them hides for the rest of its way.
template <std::floating_point R>
void Scanner<R>::enter(int x, Work& work) {
  for (const Span* s = std::exchange(work.first_at(x), nullptr); s != nullptr; s = s->next) {
    if (hidden(*s, work)) continue;
    std::erase_if(work.active, [&](const Span* other) { return s->end >= other->end && other->behind(*s); });
    work.active.push_back(s);
  }
}

// The first pixel in (x, end) at which a span begins that is not hidden at once, or `end`. Forgets those that are.
template <std::floating_point R>
int Scanner<R>::next_begin(int x, int end, Work& work) {
  for (++x; x < end; ++x) {
    const Span* s = work.first_at(x);
    while (s != nullptr && hidden(*s, work)) s = s->next;
    work.first_at(x) = s;
    if (s != nullptr) return x;
  }
  return end;
}

// Of the active spans those that may be seen: not behind the one whose farthest depth is nearest.
template <std::floating_point R>
void Scanner<R>::choose_rivals(Work& work) {
  const Span* front = *std::min_element(work.active.begin(), work.active.end(), [](auto* a, auto* b) {
    return a->depth.greatest < b->depth.greatest;
  });
  work.here.clear();
  for (const Span* s : work.active)
    if (!s->behind(*front)) work.here.push_back(s);
  work.comparisons += static_cast<std::uint32_t>(work.active.size() - 1);
}

// Moves along the line from one begin or end of a span to the next.
template <std::floating_point R>
void Scanner<R>::sweep(Work& work, const Line& line, const Watch& watch) const {
  work.active.clear();
  for (int x = work.x0; x < work.end();) {
    enter(x, work);
    if (work.active.empty()) {
      x = next_begin(x, work.end(), work);
      continue;
    }
    int end = work.active.front()->end;
    for (const Span* s : work.active) end = std::min(end, s->end);
    end = next_begin(x, end, work);
    end = x + (end - x + line.period - 1) / line.period * line.period;  // a pixel of the line's own
    choose_rivals(work);
    Segment seen{line.y,
                 line.sample,
                 x,
                 end,
                 static_cast<std::uint32_t>(work.active.size()),
                 std::exchange(work.comparisons, 0u),
                 0};
    decide(work.here, 0, x, end, line, seen, watch);
    if (watch.counts != nullptr) {
      ++watch.counts->segments;
      watch.counts->comparisons += seen.comparisons;
      watch.counts->most_active = std::max<std::uint64_t>(watch.counts->most_active, work.active.size());
    }
    seen.face = line.id[x];
    if (watch.segment) watch.segment(seen);
    x = end;
    std::erase_if(work.active, [&](const Span* s) { return s->end <= x; });
  }
}

template <std::floating_point R>
void Scanner<R>::fill(PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z, const Watch& watch) const {
  const std::vector<Part> edge_table = by_first_row(parts_of(rect), rect);
  const kernels::SamplePositions& pattern = scene_.pattern;
  Active active;
  Work work{.first = std::vector<const Span*>(static_cast<std::size_t>(rect.x1 - rect.x0)), .x0 = rect.x0};
  std::size_t next = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    std::erase_if(active.now, [&](std::uint32_t place) {
      const bool ends = active.faces[place].box.y1 <= y;
      if (ends) active.free.push_back(place);
      return ends;
    });
    for (; next < edge_table.size() && edge_table[next].box.y0 <= y; ++next)
      begin_face(edge_table[next], active);
    work.spans.reserve(active.now.size());
    for (int s = 0; s < pattern.samples; ++s) {
      std::uint32_t* id_row = id.row(s, y - rect.y0);
      R* z_row = z.row(s, y - rect.y0);
      std::fill_n(id_row, rect.x1 - rect.x0, kernels::no_face);
      std::fill_n(z_row, rect.x1 - rect.x0, scene_.far());
      for (int phase = 0; phase < pattern.period; ++phase) {
        const std::size_t i = pattern.index(s, phase, y);
        const Line line{
            s, y, phase, pattern.period, pattern.x[i], pattern.y[i], id_row - rect.x0, z_row - rect.x0};
        find_spans(active, line, work);
        if (watch.counts != nullptr) {
          ++watch.counts->lines;
          watch.counts->edges += 3 * active.now.size();
          watch.counts->spans += work.spans.size();
        }
        sweep(work, line, watch);
      }
    }
  }
}

}  // namespace frustum::scanline
