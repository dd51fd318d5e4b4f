// Pieces of screen faces: what algorithms that split faces cut them into.
//
// A piece is a face and the cuts that made it; a sample of the face belongs to it when it lies on the piece's
// side of every cut. Both sides of a cut ask the same question of the same numbers, so the pieces of a face
// share out its samples exactly, with neither a gap nor an overlap, and no vertex that a cut makes decides
// coverage: outlines are for finding order only (a plane-based representation, after Bernstein & Fussell 2009,
// Fast, Exact, Linear Booleans, doi:10.1111/j.1467-8659.2009.01504.x).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/box_triangles.h"
#include "nodes/kernels/face_depth.h"

namespace frustum::kernels {

// Where a face was cut, and on which side the piece lies.
struct Cut {
  enum class Kind : std::uint8_t {
    plane,   // along the plane of face `of`; low: nearer than it, or level with it
    side,    // along side `of` % 4 of face `of` / 4; low: where that face's edge function is not negative
    column,  // along x = of (px); low: to the left of it
    row      // along y = of (px); low: above it
  };
  Kind kind;
  bool low;
  std::uint32_t of;

  bool operator==(const Cut&) const = default;
};

// Twice the area (px^2) spanned by side k and a point, positive on the face's inside.
inline double side_function(const ScreenFace& f, std::uint32_t k, const glm::dvec2& p) {
  const glm::dvec2 a = to_px(f.corner[k]), b = to_px(f.corner[(k + 1) % 3]);
  const double turn = twice_area(f.corner[0], f.corner[1], f.corner[2]) > 0 ? 1 : -1;
  return turn * ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x));
}

// The cut's question about one point of a face: at most 0 on the low side. For a plane the difference of two
// depths, each computed from its own anchor.
inline double cut_at(const Cut& cut, const FaceDepth& face, std::span<const ScreenFace> faces,
                     const glm::dvec2& p) {
  switch (cut.kind) {
    case Cut::Kind::plane: return face.at(p) - faces[cut.of].depth.at(p);
    case Cut::Kind::side: return -side_function(faces[cut.of / 4], cut.of % 4, p);
    // Samples lie at or right of their pixel's left border: x < of is x - of < 0, and never 0 on the low side.
    case Cut::Kind::column: return p.x < cut.of ? -1.0 : 1.0;
    case Cut::Kind::row: return p.y < cut.of ? -1.0 : 1.0;
  }
  return 0;
}
inline bool on_side(const Cut& cut, const FaceDepth& face, std::span<const ScreenFace> faces,
                    const glm::dvec2& p) {
  return (cut_at(cut, face, faces, p) <= 0) == cut.low;
}

// A convex outline in px. It holds every sample of its piece, but for place_error_px.
using Outline = std::vector<glm::dvec2>;

struct Piece {
  std::uint32_t face = 0;
  std::vector<Cut> cuts;
  Outline outline;
  bool exact = false;  // the outline is the whole face: no corner of it was computed
  // Which side of a cut it is known to be on: 1 low, -1 high, 0 unknown.
  int known_side(Cut::Kind kind, std::uint32_t of) const {
    for (const Cut& c : cuts)
      if (c.kind == kind && c.of == of) return c.low ? 1 : -1;
    return 0;
  }
};

// Keeps the part of a convex outline where distance(p) <= 0; touching it in a point leaves nothing.
template <class Distance>
Outline clipped(const Outline& outline, const Distance& distance) {
  Outline kept;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 &a = outline[i], &b = outline[i + 1 == outline.size() ? 0 : i + 1];
    const double da = distance(a), db = distance(b);
    if (da <= 0) kept.push_back(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) kept.push_back(a + (b - a) * (da / (da - db)));
  }
  if (kept.size() < 3) kept.clear();
  return kept;
}

// The distances of an outline's corners from where a plane would cut it: depth of the piece's face minus
// depth of the other face. Negative is nearer.
struct DepthSpan {
  double least = std::numeric_limits<double>::infinity();
  double greatest = -std::numeric_limits<double>::infinity();
  void add(double d) {
    least = d < least ? d : least;
    greatest = d > greatest ? d : greatest;
  }
};
inline DepthSpan depth_range(const Outline& outline, const FaceDepth& face) {
  DepthSpan r;
  for (const glm::dvec2& p : outline) r.add(face.at(p));
  return r;
}
inline DepthSpan depth_difference(const Outline& outline, const FaceDepth& face, const FaceDepth& other) {
  DepthSpan r;
  for (const glm::dvec2& p : outline) r.add(face.at(p) - other.at(p));
  return r;
}

// What is drawn of a face within the window: its outline is empty where they do not meet.
inline Piece whole_piece(std::uint32_t index, const ScreenFace& face, PixelRect window) {
  Piece piece{index, {}, {}, true};
  Outline& o = piece.outline;
  for (const GridPoint& c : face.corner) o.push_back(to_px(c));
  if (twice_area(face.corner[0], face.corner[1], face.corner[2]) < 0) std::swap(o[1], o[2]);
  const auto inside = [&](const glm::dvec2& p) {
    return window.x0 <= p.x && p.x <= window.x1 && window.y0 <= p.y && p.y <= window.y1;
  };
  if (inside(o[0]) && inside(o[1]) && inside(o[2])) return piece;
  piece.exact = false;
  o = clipped(o, [&](const glm::dvec2& p) { return window.x0 - p.x; });
  o = clipped(o, [&](const glm::dvec2& p) { return p.x - window.x1; });
  o = clipped(o, [&](const glm::dvec2& p) { return window.y0 - p.y; });
  o = clipped(o, [&](const glm::dvec2& p) { return p.y - window.y1; });
  return piece;
}

// The two sides of a piece; an outline may come out empty.
struct Halves {
  Piece low, high;
};
inline Halves split(const Piece& piece, Cut::Kind kind, std::uint32_t of, std::span<const ScreenFace> faces) {
  Halves h{piece, piece};
  h.low.exact = h.high.exact = false;
  h.low.cuts.push_back({kind, true, of});
  h.high.cuts.push_back({kind, false, of});
  const FaceDepth& own = faces[piece.face].depth;
  const auto distance = [&](const glm::dvec2& p) {
    if (kind == Cut::Kind::column) return p.x - of;
    if (kind == Cut::Kind::row) return p.y - of;
    return cut_at({kind, true, of}, own, faces, p);
  };
  h.low.outline = clipped(piece.outline, distance);
  h.high.outline = clipped(piece.outline, [&](const glm::dvec2& p) { return -distance(p); });
  return h;
}

}  // namespace frustum::kernels
