// Depth sort: the farthest face is painted first, once it is certain that it hides nobody who is left; who
// cannot be put in order is exchanged, and where that goes in a circle, cut.
// Source: Newell, Newell & Sancha 1972, A Solution to the Hidden Surface Problem, doi:10.1145/800193.569954.
// Departures: tests know how far rounding reaches (face_depth.h); a circle of faces none of which crosses the
// plane of another, which the paper does not mention, is cut along their sides.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <set>
#include <span>
#include <vector>

#include "nodes/kernels/piece_order.h"

namespace frustum::depth_sort {

// What was found of a pair, or done about it.
enum class Event : std::uint8_t {
  beside_x,    // their boxes do not overlap in x
  beside_y,    // ... in y
  behind,      // the candidate lies wholly behind the other's plane
  before,      // the other lies wholly before the candidate's plane
  apart,       // their outlines do not overlap
  overlap,     // where they overlap, the candidate lies behind; asked only in a circle that no cut opens
  exchange,    // the other is tried first
  split,       // the first is cut by the plane of the second
  split_side,  // the first is cut along a side of the second
  unresolved,  // in a circle that no cut opens; painted as it comes
  painted      // the candidate hides nobody who is left
};

struct Step {
  std::uint32_t first, second;  // faces; the same for `painted`
  Event event;
};

struct Counts {
  std::uint64_t comparisons = 0, exchanges = 0, splits = 0, unresolved = 0;
};

struct Watch {
  std::function<void()> poll = [] {};
  std::function<void(std::uint64_t bytes)> claim = [](std::uint64_t) {};
  std::function<void(const Step&)> step = [](const Step&) {};
};

class Sorter {
 public:
  Sorter(std::span<const kernels::ScreenFace> faces, kernels::PixelRect window, const Watch& watch)
      : faces_(faces), watch_(watch) {
    for (std::uint32_t f = 0; f < faces.size(); ++f)
      if (faces[f].drawn) insert(kernels::whole_piece(f, faces[f], window));
  }

  // Calls emit(piece) for every piece that meets the window, the first to be painted first.
  // Cost: O(n^2) comparisons where all depths overlap, O(n log n) where none do; splits add pieces.
  template <class Emit>
  Counts run(const Emit& emit) {
    while (!left_.empty()) {
      const std::uint32_t next = search();
      if (next == none) continue;  // something was cut: the list begins anew
      note(next, next, Event::painted);
      emit(static_cast<const kernels::Piece&>(piece(next)));
      remove(next);
      careful_ = false;
    }
    return counts_;
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFu;
  struct Entry {
    double farthest;
    std::uint32_t id;
    bool operator<(const Entry& b) const {
      return farthest != b.farthest ? farthest > b.farthest : id < b.id;
    }
  };
  struct Pending {
    kernels::PlacedPiece at;
    std::uint64_t tried = 0;  // the search in which it was a candidate
  };

  const kernels::Piece& piece(std::uint32_t id) const { return pieces_[id].at.piece; }
  void note(std::uint32_t p, std::uint32_t q, Event event) const {
    watch_.step({piece(p).face, piece(q).face, event});
  }

  void insert(kernels::Piece piece) {
    if (piece.outline.empty()) return;
    watch_.claim(sizeof(Pending) + 64 + piece.cuts.size() * sizeof(kernels::Cut) +
                 piece.outline.size() * sizeof(glm::dvec2));
    const auto id = static_cast<std::uint32_t>(pieces_.size());
    pieces_.push_back({kernels::PlacedPiece::make(std::move(piece), faces_)});
    left_.insert({pieces_.back().at.depth.greatest, id});
  }
  void remove(std::uint32_t id) {
    left_.erase({pieces_[id].at.depth.greatest, id});
    pieces_[id].at.piece = {};
  }

  // A piece that hides nobody who is left, or `none` after a cut.
  std::uint32_t search() {
    ++round_;
    std::vector<std::uint32_t> chain;
    std::uint32_t candidate = left_.begin()->id;
    for (;;) {
      pieces_[candidate].tried = round_;
      chain.push_back(candidate);
      const std::uint32_t other = first_hidden_by(candidate);
      if (other == none) return candidate;
      if (pieces_[other].tried == round_) return open_circle(chain, other) ? none : candidate;
      if (!may_come_first(other, candidate)) {
        cut(candidate, kernels::Cut::Kind::plane, piece(other).face, other);
        return none;
      }
      ++counts_.exchanges;
      note(candidate, other, Event::exchange);
      candidate = other;
    }
  }

  // The first piece that `p` may hide where it is painted now, in order of depth; `none` where there is none.
  // Those that lie wholly nearer than p end the search: the first of the five tests.
  std::uint32_t first_hidden_by(std::uint32_t p) {
    const double nearest = pieces_[p].at.depth.least;
    for (const Entry& e : left_) {
      if (e.farthest <= nearest) break;
      if (e.id != p && may_hide(p, e.id)) return e.id;
    }
    return none;
  }

  // Whether p may hide a part of q, by the tests that are left.
  bool may_hide(std::uint32_t p, std::uint32_t q) {
    const kernels::PlacedPiece &a = pieces_[p].at, &b = pieces_[q].at;
    if (++counts_.comparisons % 1024 == 0) watch_.poll();
    const auto found = [&](Event event) {
      note(p, q, event);
      return false;
    };
    using kernels::Side;
    if (kernels::beside(a, b, 0)) return found(Event::beside_x);
    if (kernels::beside(a, b, 1)) return found(Event::beside_y);
    const Side of_a = kernels::side_of(a, b, faces_);
    if (of_a == Side::behind || of_a == Side::level) return found(Event::behind);
    const Side of_b = kernels::side_of(b, a, faces_);
    if (of_b == Side::before || of_b == Side::level) return found(Event::before);
    if (kernels::outlines_apart(a, b, faces_)) return found(Event::apart);
    if (!careful_) return true;
    const double level = faces_[a.piece.face].depth.level + faces_[b.piece.face].depth.level;
    return kernels::depth_in_overlap(a, b, faces_).least < -level || found(Event::overlap);
  }

  // Whether q, which p may hide, may be painted before p: the tests the other way round.
  bool may_come_first(std::uint32_t q, std::uint32_t p) const {
    const kernels::PlacedPiece &a = pieces_[p].at, &b = pieces_[q].at;
    return b.depth.least >= a.depth.greatest || kernels::side_of(b, a, faces_) == kernels::Side::behind ||
           kernels::side_of(a, b, faces_) == kernels::Side::before;
  }

  void cut(std::uint32_t p, kernels::Cut::Kind kind, std::uint32_t of, std::uint32_t other) {
    note(p, other, kind == kernels::Cut::Kind::plane ? Event::split : Event::split_side);
    ++counts_.splits;
    kernels::Halves halves = kernels::split(piece(p), kind, of, faces_);
    remove(p);
    insert(std::move(halves.low));
    insert(std::move(halves.high));
  }

  // The candidates, each of which may hide the next, and the last may hide `other`, which was one of them: cuts
  // one of them, or has the search repeated with more care. False where neither helps.
  bool open_circle(const std::vector<std::uint32_t>& chain, std::uint32_t other) {
    std::size_t first = 0;
    while (chain[first] != other) ++first;
    for (std::size_t i = chain.size(); i-- > first;) {
      const std::uint32_t p = chain[i], q = i + 1 < chain.size() ? chain[i + 1] : other;
      if (cut_by_plane(p, q) || cut_by_plane(q, p)) return true;
    }
    for (std::size_t i = chain.size(); i-- > first;) {
      const std::uint32_t p = chain[i], q = i + 1 < chain.size() ? chain[i + 1] : other;
      if (cut_by_side(p, q) || cut_by_side(q, p)) return true;
    }
    // The tests are careful: of pieces whose outlines touch they may see a circle that is none.
    if (!careful_) return careful_ = true;
    ++counts_.unresolved;
    note(chain.back(), other, Event::unresolved);
    return false;
  }
  bool cut_by_plane(std::uint32_t p, std::uint32_t q) {
    if (kernels::side_of(pieces_[p].at, pieces_[q].at, faces_) != kernels::Side::across) return false;
    cut(p, kernels::Cut::Kind::plane, piece(q).face, q);
    return true;
  }
  // Along a side of q's face that has corners of p farther than rounding on both sides.
  bool cut_by_side(std::uint32_t p, std::uint32_t q) {
    const std::uint32_t face = piece(q).face;
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (piece(p).known_side(kernels::Cut::Kind::side, 4 * face + k) != 0) continue;
      const glm::dvec2 a = kernels::to_px(faces_[face].corner[k]);
      const glm::dvec2 b = kernels::to_px(faces_[face].corner[(k + 1) % 3]);
      const double reach = kernels::place_error_px * (std::fabs(b.x - a.x) + std::fabs(b.y - a.y));
      kernels::DepthSpan d;
      for (const glm::dvec2& c : piece(p).outline) d.add(kernels::side_function(faces_[face], k, c));
      if (d.least >= -reach || d.greatest <= reach) continue;
      cut(p, kernels::Cut::Kind::side, 4 * face + k, q);
      return true;
    }
    return false;
  }

  std::span<const kernels::ScreenFace> faces_;
  const Watch& watch_;
  std::deque<Pending> pieces_;
  std::set<Entry> left_;
  std::uint64_t round_ = 0;
  bool careful_ = false;  // ask of overlaps, too
  Counts counts_;
};

}  // namespace frustum::depth_sort
