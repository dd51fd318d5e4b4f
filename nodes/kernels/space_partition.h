// Binary space partitioning: planes of faces divide the others, once, and any eye then finds an order by
// asking of each plane on which side it stands.
// Source: Fuchs, Kedem & Naylor 1980, On Visible Surface Generation by A Priori Tree Structures,
// doi:10.1145/965105.807481. Departures: faces level with a plane stand with it in a list; `balanced` also cuts
// along columns and rows of pixels, since a convex solid has no plane of a face that divides it.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec4.hpp>

#include "nodes/kernels/piece_order.h"

namespace frustum::bsp {

using kernels::Cut;
using kernels::Piece;
using kernels::ScreenFace;

// Which plane divides the pieces of a cell.
enum class Splitter : std::uint8_t {
  first,         // that of the first face
  least_splits,  // of some candidates the one that cuts the fewest
  balanced       // of those and the middle column and row the one with the best balance for its cuts
};

inline constexpr std::uint32_t no_node = 0xFFFFFFFFu;

struct Node {
  Cut::Kind kind;       // plane (of face `of`), column or row
  std::uint32_t of;     // the face, or the pixel
  std::uint32_t depth;  // 0 at the root
  std::uint32_t low = no_node,
                high = no_node;  // nodes: before and behind the plane, left and right, above and below
  std::uint32_t first_piece = 0, pieces = 0;                  // those level with the plane, in Tree::pieces
  std::uint32_t low_pieces = 0, high_pieces = 0, splits = 0;  // when the cell was divided
};

struct Tree {
  std::vector<Node> nodes;    // parents stand before children; the root is the first
  std::vector<Piece> pieces;  // of all nodes
  std::uint64_t faces = 0;    // that went in
  std::uint64_t comparisons = 0, splits = 0;
  std::uint32_t depth = 0;
};

struct Options {
  Splitter splitter = Splitter::balanced;
  int candidates = 8;
};

struct Watch {
  std::function<void()> poll = [] {};
  std::function<void(std::uint64_t bytes)> claim = [](std::uint64_t) {};
};

namespace detail {

// What a divider would do to a cell, judged by some of its pieces.
struct Division {
  std::uint64_t low = 0, high = 0, splits = 0;
  std::uint64_t uneven() const { return low > high ? low - high : high - low; }
};

class Builder {
 public:
  Builder(std::span<const ScreenFace> faces, const Options& options, const Watch& watch)
      : faces_(faces), options_(options), watch_(watch) {}

  Tree build(kernels::PixelRect window) {
    Cell root;
    for (std::uint32_t f = 0; f < faces_.size(); ++f) {
      if (!faces_[f].drawn) continue;
      Piece whole = kernels::whole_piece(f, faces_[f], window);
      if (!whole.outline.empty()) root.pieces.push_back(std::move(whole));
    }
    tree_.faces = root.pieces.size();
    watch_.claim(root.pieces.size() * piece_bytes);
    std::vector<Cell> cells;
    if (!root.pieces.empty()) cells.push_back(std::move(root));
    while (!cells.empty()) {
      Cell cell = std::move(cells.back());
      cells.pop_back();
      divide(std::move(cell), cells);
    }
    return std::move(tree_);
  }

 private:
  static constexpr std::size_t piece_bytes = sizeof(Piece) + 6 * sizeof(glm::dvec2);
  static constexpr std::size_t judged = 128;  // pieces; more judge no better and cost O(n) a candidate

  struct Cell {
    std::vector<Piece> pieces;
    std::uint32_t parent = no_node, depth = 0;
    bool low = false;
  };

  kernels::Side side(const Piece& p, Cut::Kind kind, std::uint32_t of) {
    ++tree_.comparisons;
    const kernels::FaceDepth& own = faces_[p.face].depth;
    if (kind == Cut::Kind::plane) {
      if (p.face == of) return kernels::Side::level;
      const kernels::FaceDepth& plane = faces_[of].depth;
      return kernels::side_of(p, own, of, plane, own.level + plane.slope_error());
    }
    const glm::length_t axis = kind == Cut::Kind::column ? 0 : 1;
    kernels::DepthSpan r;
    for (const glm::dvec2& q : p.outline) r.add(q[axis]);
    if (r.greatest + slack(p) <= of) return kernels::Side::before;
    return r.least - slack(p) >= of ? kernels::Side::behind : kernels::Side::across;
  }
  static double slack(const Piece& p) { return p.exact ? 0 : kernels::place_error_px; }

  Division judge(const std::vector<Piece>& pieces, Cut::Kind kind, std::uint32_t of) {
    Division d;
    const std::size_t n = std::min(pieces.size(), judged);
    for (std::size_t i = 0; i < n; ++i) {
      const kernels::Side s = side(pieces[i * pieces.size() / n], kind, of);
      d.low += s == kernels::Side::before || s == kernels::Side::across;
      d.high += s == kernels::Side::behind || s == kernels::Side::across;
      d.splits += s == kernels::Side::across;
    }
    return d;
  }

  // Lower is better. A cut costs a piece for ever after, a piece too many on one side some levels of one half.
  double cost(const Division& d) const {
    const auto splits = static_cast<double>(d.splits), uneven = static_cast<double>(d.uneven());
    return options_.splitter == Splitter::balanced ? 4 * splits + uneven : splits + uneven * 0x1p-20;
  }

  // The pixel border nearest to the median of the boxes' middles.
  std::optional<std::uint32_t> middle(const std::vector<Piece>& pieces, glm::length_t axis) const {
    const std::size_t n = std::min(pieces.size(), judged);
    std::vector<double> at;
    for (std::size_t i = 0; i < n; ++i) {
      kernels::DepthSpan r;
      for (const glm::dvec2& q : pieces[i * pieces.size() / n].outline) r.add(q[axis]);
      at.push_back((r.least + r.greatest) / 2);
    }
    std::nth_element(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(n / 2), at.end());
    const double median = std::round(at[n / 2]);
    return median > 0 ? std::optional(static_cast<std::uint32_t>(median)) : std::nullopt;
  }

  std::pair<Cut::Kind, std::uint32_t> choose(const std::vector<Piece>& pieces) {
    std::pair<Cut::Kind, std::uint32_t> best{Cut::Kind::plane, pieces.front().face};
    if (options_.splitter == Splitter::first || pieces.size() == 1) return best;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](Cut::Kind kind, std::uint32_t of) {
      const Division d = judge(pieces, kind, of);
      const std::uint64_t all = std::min(pieces.size(), judged);
      if (kind != Cut::Kind::plane && (d.low >= all || d.high >= all)) return;  // would leave a cell as large
      if (const double c = cost(d); c < least) least = c, best = {kind, of};
    };
    const std::size_t n = std::min(pieces.size(), static_cast<std::size_t>(options_.candidates));
    for (std::size_t i = 0; i < n; ++i)
      consider(Cut::Kind::plane, pieces[(2 * i + 1) * pieces.size() / (2 * n)].face);
    if (options_.splitter != Splitter::balanced) return best;
    if (const auto x = middle(pieces, 0)) consider(Cut::Kind::column, *x);
    if (const auto y = middle(pieces, 1)) consider(Cut::Kind::row, *y);
    return best;
  }

  void divide(Cell cell, std::vector<Cell>& cells) {
    watch_.poll();
    const auto [kind, of] = choose(cell.pieces);
    const auto index = static_cast<std::uint32_t>(tree_.nodes.size());
    if (cell.parent != no_node)
      (cell.low ? tree_.nodes[cell.parent].low : tree_.nodes[cell.parent].high) = index;
    Node node{kind, of, cell.depth};
    node.first_piece = static_cast<std::uint32_t>(tree_.pieces.size());
    Cell low{{}, index, cell.depth + 1, true}, high{{}, index, cell.depth + 1, false};
    for (Piece& p : cell.pieces) {
      switch (side(p, kind, of)) {
        case kernels::Side::level: tree_.pieces.push_back(std::move(p)); break;
        case kernels::Side::before: low.pieces.push_back(std::move(p)); break;
        case kernels::Side::behind: high.pieces.push_back(std::move(p)); break;
        case kernels::Side::across: {
          kernels::Halves halves = kernels::split(p, kind, of, faces_);
          low.pieces.push_back(std::move(halves.low));
          high.pieces.push_back(std::move(halves.high));
          ++node.splits;
        }
      }
    }
    node.pieces = static_cast<std::uint32_t>(tree_.pieces.size()) - node.first_piece;
    node.low_pieces = static_cast<std::uint32_t>(low.pieces.size());
    node.high_pieces = static_cast<std::uint32_t>(high.pieces.size());
    watch_.claim(sizeof(Node) + node.splits * (piece_bytes + sizeof(Cut)));
    tree_.splits += node.splits;
    tree_.depth = std::max(tree_.depth, node.depth + 1);
    tree_.nodes.push_back(node);
    if (!high.pieces.empty()) cells.push_back(std::move(high));
    if (!low.pieces.empty()) cells.push_back(std::move(low));
  }

  std::span<const ScreenFace> faces_;
  const Options& options_;
  const Watch& watch_;
  Tree tree_;
};

}  // namespace detail

// The tree of the faces that meet the window. Every face is in it, whole or in pieces that share out its
// samples. Cost: O(n depth) comparisons of pieces; a convex solid divided by planes of its faces alone has
// depth n.
inline Tree build(std::span<const ScreenFace> faces, kernels::PixelRect window, const Options& options,
                  const Watch& watch = {}) {
  return detail::Builder(faces, options, watch).build(window);
}

// On which side of a node's divider an eye stands: below 0 the low one, 0 on it.
//   eye  (x_px, y_px, depth, 1) with depths that grow away from the camera, or a direction (x, y, z, 0) that it
//        is infinitely far in; the camera's own eye, whose rays are parallel on the screen, is (0, 0, -1, 0)
inline double eye_side(const Node& n, std::span<const ScreenFace> faces, const glm::dvec4& eye) {
  if (n.kind == Cut::Kind::column) return eye.x - n.of * eye.w;
  if (n.kind == Cut::Kind::row) return eye.y - n.of * eye.w;
  const kernels::FaceDepth& d = faces[n.of].depth;
  return eye.z - (d.z * eye.w + d.dx * (eye.x - d.anchor.x * eye.w) + d.dy * (eye.y - d.anchor.y * eye.w));
}

// Calls visit(node) for every node so that, seen from the eye, no piece hides one of a node before it; or, front
// to back, of a node after it. An eye on a divider sees its pieces from the side, and neither half hides the
// other. Cost: O(nodes).
template <class Visit>
void traverse(const Tree& tree, std::span<const ScreenFace> faces, const glm::dvec4& eye, bool front_to_back,
              const Visit& visit) {
  struct Stop {
    std::uint32_t node;
    bool halfway;
  };
  std::vector<Stop> path;
  if (!tree.nodes.empty()) path.push_back({0, false});
  while (!path.empty()) {
    const Stop stop = path.back();
    path.pop_back();
    const Node& n = tree.nodes[stop.node];
    if (stop.halfway) {
      visit(n);
      continue;
    }
    const bool low_first = (eye_side(n, faces, eye) <= 0) == front_to_back;
    const std::uint32_t first = low_first ? n.low : n.high, last = low_first ? n.high : n.low;
    if (last != no_node) path.push_back({last, false});
    path.push_back({stop.node, true});
    if (first != no_node) path.push_back({first, false});
  }
}

}  // namespace frustum::bsp
