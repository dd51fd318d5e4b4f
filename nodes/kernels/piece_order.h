// Which of two pieces may hide the other: the five tests of Newell, Newell & Sancha 1972, A Solution to the
// Hidden Surface Problem, doi:10.1145/800193.569954, from cheap to dear. Every answer "they do not" holds at
// every sample, but for depths within the faces' bands (face_depth.h); "they may" may be too careful.
#pragma once

#include "nodes/kernels/face_piece.h"

namespace frustum::kernels {

// A piece with what the cheap tests ask: its box in px, and its depths.
struct PlacedPiece {
  Piece piece;
  glm::dvec2 low{0}, high{0};
  DepthSpan depth;

  // An empty outline gives an empty box, which is beside everything.
  static PlacedPiece make(Piece piece, std::span<const ScreenFace> faces) {
    PlacedPiece p;
    p.depth = depth_range(piece.outline, faces[piece.face].depth);
    p.low = glm::dvec2(std::numeric_limits<double>::infinity());
    p.high = -p.low;
    for (const glm::dvec2& q : piece.outline) {
      p.low = {std::min(p.low.x, q.x), std::min(p.low.y, q.y)};
      p.high = {std::max(p.high.x, q.x), std::max(p.high.y, q.y)};
    }
    p.piece = std::move(piece);
    return p;
  }
  // How far its samples may lie outside its outline: corners of faces are exact, those that a cut made are not.
  double slack_px() const { return piece.exact ? 0 : place_error_px; }
};

// A sample on a common border belongs to one of two whole faces only (the top-left rule), so touching boxes
// share none; those of cut pieces may.
inline bool beside(const PlacedPiece& p, const PlacedPiece& q, glm::length_t axis) {
  const double slack = p.slack_px() + q.slack_px();
  return p.high[axis] + slack <= q.low[axis] || q.high[axis] + slack <= p.low[axis];
}

// Where a piece lies, seen from the eye, of the plane of another's face.
enum class Side : std::uint8_t { behind, before, level, across };

inline Side side_of(const Piece& p, const FaceDepth& depth, std::uint32_t plane, const FaceDepth& of,
                    double tolerance) {
  if (const int known = p.known_side(Cut::Kind::plane, plane); known != 0)
    return known > 0 ? Side::before : Side::behind;
  const DepthSpan d = depth_difference(p.outline, depth, of);
  const bool behind = d.least >= -tolerance, before = d.greatest <= tolerance;
  if (behind) return before ? Side::level : Side::behind;
  return before ? Side::before : Side::across;
}

// Of two pieces alone: depths within both levels have no order.
inline Side side_of(const PlacedPiece& p, const PlacedPiece& q, std::span<const ScreenFace> faces) {
  const FaceDepth &own = faces[p.piece.face].depth, &other = faces[q.piece.face].depth;
  return side_of(p.piece, own, q.piece.face, other, own.level + other.level);
}

namespace piece_order_detail {

// Whether a side of `a` has all of `b` outside. Both turn the same way, positive inside. Sides that cuts have left
// shorter than 2^-4 px are not asked: rounding decides where they point.
inline bool has_dividing_side(const Outline& a, const Outline& b, double slack_px) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const glm::dvec2 &p = a[i], side = a[i + 1 == a.size() ? 0 : i + 1] - p;
    const double length = std::fabs(side.x) + std::fabs(side.y);
    if (slack_px > 0 && length < 0x1p-4) continue;
    const double reach = -slack_px * length;
    bool outside = true;
    for (const glm::dvec2& q : b) outside = outside && side.x * (q.y - p.y) - side.y * (q.x - p.x) <= reach;
    if (outside) return true;
  }
  return false;
}

// The same for whole faces, in whole numbers: exact.
inline bool has_dividing_side(const ScreenFace& a, const ScreenFace& b) {
  const bool turned = twice_area(a.corner[0], a.corner[1], a.corner[2]) < 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const GridPoint p = a.corner[turned ? (k + 1) % 3 : k], q = a.corner[turned ? k : (k + 1) % 3];
    if (std::all_of(b.corner.begin(), b.corner.end(), [&](GridPoint c) { return twice_area(p, q, c) <= 0; }))
      return true;
  }
  return false;
}

}  // namespace piece_order_detail

// Whether no sample lies in both outlines: a line along a side of one divides them.
inline bool outlines_apart(const PlacedPiece& p, const PlacedPiece& q, std::span<const ScreenFace> faces) {
  using piece_order_detail::has_dividing_side;
  if (p.piece.face == q.piece.face) return true;  // pieces of a face share out its samples
  const ScreenFace &a = faces[p.piece.face], &b = faces[q.piece.face];
  if (has_dividing_side(a, b) || has_dividing_side(b, a)) return true;
  if (p.piece.exact && q.piece.exact) return false;
  const double slack = p.slack_px() + q.slack_px();
  return has_dividing_side(p.piece.outline, q.piece.outline, slack) ||
         has_dividing_side(q.piece.outline, p.piece.outline, slack);
}

// The range of the depth of p minus the depth of q where their outlines overlap, each as far as its samples may
// reach; empty (least > greatest) where they do not.
inline DepthSpan depth_in_overlap(const PlacedPiece& p, const PlacedPiece& q,
                                  std::span<const ScreenFace> faces) {
  const double slack = p.slack_px() + q.slack_px();
  Outline both = p.piece.outline;
  const Outline& other = q.piece.outline;
  for (std::size_t i = 0; i < other.size() && !both.empty(); ++i) {
    const glm::dvec2 &a = other[i], side = other[i + 1 == other.size() ? 0 : i + 1] - a;
    const double reach = slack * (std::fabs(side.x) + std::fabs(side.y));
    both = clipped(both,
                   [&](const glm::dvec2& r) { return side.y * (r.x - a.x) - side.x * (r.y - a.y) - reach; });
  }
  return depth_difference(both, faces[p.piece.face].depth, faces[q.piece.face].depth);
}

}  // namespace frustum::kernels
