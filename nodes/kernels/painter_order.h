// The painter's algorithm: whole faces, the farthest first, each over what is there.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <queue>
#include <span>
#include <vector>

#include "nodes/kernels/piece_order.h"

namespace frustum::painter {

// By what faces are put in order: one depth of each, which is cheap and often wrong; or by who hides whom,
// which is right whenever there is an order that is.
enum class Key : std::uint8_t { farthest, middle, nearest, overlap };

struct Order {
  std::vector<std::uint32_t> face;   // the drawn faces, first to last
  std::vector<std::uint32_t> cycle;  // of each: the cycle of faces that hide one another, from 1; 0: in none
  std::uint64_t comparisons = 0;     // pairs looked at
  std::uint64_t hidings = 0;         // pairs of which one hides the other somewhere
  std::uint32_t cycles = 0;
};

// What the algorithm may be asked to do while it works; both may throw.
struct Watch {
  std::function<void()> poll = [] {};
  std::function<void(std::uint64_t bytes)> claim = [](std::uint64_t) {};
};

namespace detail {

using kernels::PlacedPiece;
using kernels::ScreenFace;

inline double key_of(Key key, const kernels::DepthSpan& d) {
  if (key == Key::nearest) return d.least;
  return key == Key::middle ? (d.least + d.greatest) / 2 : d.greatest;
}

// Who has to be painted before whom, as lists of followers.
class HidingGraph {
 public:
  explicit HidingGraph(std::size_t n) : after_(n) {}
  void add(std::uint32_t before, std::uint32_t after) { after_[before].push_back(after); }
  std::size_t size() const { return after_.size(); }
  std::span<const std::uint32_t> after(std::uint32_t i) const { return after_[i]; }

  // The strongly connected component of each node, numbered so that every edge between components goes from a
  // greater to a smaller number. Source: Tarjan 1972, SIAM J. Comput. 1:146, here without recursion.
  std::vector<std::uint32_t> components() const {
    Walk w{std::vector<std::uint32_t>(size(), 0),
           std::vector<std::uint32_t>(size(), 0),
           std::vector<std::uint32_t>(size(), unset),
           {},
           {},
           0,
           0};
    for (std::uint32_t root = 0; root < size(); ++root) {
      if (w.number[root] == 0) w.enter(root);
      while (!w.path.empty()) step(w);
    }
    return w.component;
  }

 private:
  static constexpr std::uint32_t unset = 0xFFFFFFFFu;
  struct Frame {
    std::uint32_t node;
    std::size_t next;
  };
  struct Walk {
    std::vector<std::uint32_t> number, low, component;
    std::vector<std::uint32_t> open;
    std::vector<Frame> path;
    std::uint32_t numbers, components;
    void enter(std::uint32_t node) {
      number[node] = low[node] = ++numbers;
      open.push_back(node);
      path.push_back({node, 0});
    }
  };

  void step(Walk& w) const {
    Frame& f = w.path.back();
    const std::uint32_t node = f.node;
    if (f.next < after_[node].size()) {
      const std::uint32_t to = after_[node][f.next++];
      if (w.number[to] == 0)
        w.enter(to);
      else if (w.component[to] == unset)
        w.low[node] = std::min(w.low[node], w.number[to]);
      return;
    }
    if (w.low[node] == w.number[node]) {
      std::uint32_t member = unset;
      while (member != node) {
        member = w.open.back();
        w.open.pop_back();
        w.component[member] = w.components;
      }
      ++w.components;
    }
    w.path.pop_back();
    if (!w.path.empty()) w.low[w.path.back().node] = std::min(w.low[w.path.back().node], w.low[node]);
  }

  std::vector<std::vector<std::uint32_t>> after_;
};

class Sorter {
 public:
  Sorter(std::span<const ScreenFace> faces, kernels::PixelRect window, Key key, const Watch& watch)
      : faces_(faces), key_(key), watch_(watch) {
    watch_.claim(faces.size() * (sizeof(PlacedPiece) + 4 * sizeof(glm::dvec2)));
    for (std::uint32_t f = 0; f < faces.size(); ++f) {
      if (!faces[f].drawn) continue;
      kernels::Piece whole = kernels::whole_piece(f, faces[f], window);
      if (!whole.outline.empty()) pieces_.push_back(PlacedPiece::make(std::move(whole), faces));
    }
    // Farthest first; what is as far in any order, as long as it is always the same one.
    std::sort(pieces_.begin(), pieces_.end(), [&](const PlacedPiece& a, const PlacedPiece& b) {
      const double ka = key_of(key, a.depth), kb = key_of(key, b.depth);
      return ka != kb ? ka > kb : a.piece.face < b.piece.face;
    });
  }

  Order run() {
    Order out;
    if (key_ != Key::overlap) {
      for (const PlacedPiece& p : pieces_) out.face.push_back(p.piece.face);
      out.cycle.assign(out.face.size(), 0);
      return out;
    }
    HidingGraph graph(pieces_.size());
    find_hidings(graph, out);
    emit(graph, out);
    return out;
  }

 private:
  // Pairs whose boxes overlap, by a sweep in y.
  void find_hidings(HidingGraph& graph, Order& out) {
    std::vector<std::uint32_t> by_top(pieces_.size()), active;
    std::iota(by_top.begin(), by_top.end(), 0u);
    std::sort(by_top.begin(), by_top.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(pieces_[a].low.y, a) < std::pair(pieces_[b].low.y, b);
    });
    for (const std::uint32_t i : by_top) {
      watch_.poll();
      std::erase_if(active, [&](std::uint32_t j) { return kernels::beside(pieces_[i], pieces_[j], 1); });
      for (const std::uint32_t j : active) compare(std::min(i, j), std::max(i, j), graph, out);
      active.push_back(i);
    }
  }

  void compare(std::uint32_t i, std::uint32_t j, HidingGraph& graph, Order& out) {
    const PlacedPiece &p = pieces_[i], &q = pieces_[j];
    ++out.comparisons;
    if (kernels::beside(p, q, 0) || kernels::outlines_apart(p, q, faces_)) return;
    const kernels::DepthSpan d = kernels::depth_in_overlap(p, q, faces_);
    const double level = faces_[p.piece.face].depth.level + faces_[q.piece.face].depth.level;
    const auto hides = [&](std::uint32_t before, std::uint32_t after) {
      watch_.claim(2 * sizeof before);
      graph.add(before, after);
      ++out.hidings;
    };
    if (d.greatest > level) hides(i, j);
    if (d.least < -level) hides(j, i);  // of both: they pierce one another, a cycle of two
  }

  // Components in order, of those that may come next the one that lies farthest; within a cycle, where no
  // order is right, by farthest depth.
  void emit(const HidingGraph& graph, Order& out) const {
    const std::vector<std::uint32_t> component = graph.components();
    const std::size_t n = component.empty() ? 0 : 1 + *std::max_element(component.begin(), component.end());
    std::vector<std::vector<std::uint32_t>> members(n);
    std::vector<std::uint32_t> waits(n, 0);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      members[component[i]].push_back(i);
      for (const std::uint32_t j : graph.after(i)) waits[component[j]] += component[i] != component[j];
    }
    // Members ascend, and pieces stand farthest first: the first member is a component's farthest.
    const auto later = [&](std::uint32_t a, std::uint32_t b) { return members[a][0] > members[b][0]; };
    std::priority_queue<std::uint32_t, std::vector<std::uint32_t>, decltype(later)> ready(later);
    for (std::uint32_t c = 0; c < n; ++c)
      if (waits[c] == 0) ready.push(c);
    while (!ready.empty()) {
      const std::uint32_t c = ready.top();
      ready.pop();
      out.cycles += members[c].size() > 1;
      for (const std::uint32_t i : members[c]) {
        out.face.push_back(pieces_[i].piece.face);
        out.cycle.push_back(members[c].size() > 1 ? out.cycles : 0);
        for (const std::uint32_t j : graph.after(i))
          if (component[j] != c && --waits[component[j]] == 0) ready.push(component[j]);
      }
    }
  }

  std::span<const ScreenFace> faces_;
  Key key_;
  const Watch& watch_;
  std::vector<PlacedPiece> pieces_;  // farthest first
};

}  // namespace detail

// The faces that meet the window, in the order in which they are to be painted. With Key::overlap an order in
// which nobody paints over whom he is hidden by, wherever there is one; faces of a cycle stand together.
// Cost: O(n log n), or with Key::overlap O(pairs whose boxes overlap in y).
// Source: Newell, Newell & Sancha 1972 for the sorting by depth; the test of cycles is ours.
inline Order order(std::span<const kernels::ScreenFace> faces, kernels::PixelRect window, Key key,
                   const Watch& watch = {}) {
  return detail::Sorter(faces, window, key, watch).run();
}

}  // namespace frustum::painter
