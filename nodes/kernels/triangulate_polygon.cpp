#include "nodes/kernels/triangulate_polygon.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "nodes/kernels/predicates.h"

namespace frustum::kernels {
namespace {

using Index = std::uint32_t;
using Triangle = std::array<Index, 3>;

// The order of the sweep: to the right and, at one x, upwards; as if the plane were turned clockwise a
// little.
bool before(const glm::dvec2& a, const glm::dvec2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

// What a corner does to the regions of the interior that the sweep line crosses. At one place, in this
// order: what ends there makes room, then what begins there finds its neighbours; an end may lie in the
// notch of a merge and a start in that of a split, and no other two with wedges that overlap meet in one
// place.
enum class Kind : std::uint8_t {
  end,    // both edges come from the left, the interior between them: the region closes
  merge,  // both come from the left, the interior around them: the regions below and above become one
  lower,  // passes on the lower side of its region
  upper,  // passes on the upper side
  split,  // both go to the right, the interior around them: the region becomes two
  start   // both go to the right, the interior between them: a region opens
};

enum class Side : std::uint8_t { lower, upper };

// The part of a monotone polygon that still waits for its triangles: corners from left to right, all but the
// first on one side, where no angle between them is below 180 degrees inside.
struct Chain {
  std::vector<Index> corners;
  Side side = Side::lower;
};

// Cuts monotone polygons into triangles while their corners arrive from left to right.
class Cutter {
 public:
  // corner[i] is the name of ring[i] in the triangles.
  Cutter(const std::vector<glm::dvec2>& ring, const std::vector<Index>& corner, std::vector<Triangle>& out)
      : p_(ring), corner_(corner), out_(out) {}

  int turn(Index a, Index b, Index c) const { return orientation(p_[a], p_[b], p_[c]); }
  bool some_clockwise() const { return clockwise_; }
  bool some_area() const { return area_; }

  // Corner v comes next, on that side. Opposite to the chain it sees all of it; on the chain's own side it
  // cuts off what has become convex.
  void add(Chain& chain, Index v, Side side) {
    auto& c = chain.corners;
    if (side != chain.side) {
      const Index last = c.back();
      close(chain, v);
      c = {last, v};
      chain.side = side;
      return;
    }
    const int convex = side == Side::lower ? 1 : -1;
    while (c.size() > 1 && turn(c[c.size() - 2], c.back(), v) == convex) {
      emit(c[c.size() - 2], c.back(), v, side, convex);
      c.pop_back();
    }
    c.push_back(v);
  }

  // Corner v is on both sides: the last one. Empties the chain.
  void close(Chain& chain, Index v) {
    const auto& c = chain.corners;
    for (std::size_t i = 0; i + 1 < c.size(); ++i)
      emit(c[i], c[i + 1], v, chain.side, turn(c[i], c[i + 1], v));
    chain.corners = {};
  }

 private:
  // a and b are on `side`, from left to right; `sign` is their turn to v.
  void emit(Index a, Index b, Index v, Side side, int sign) {
    if (side == Side::upper) std::swap(a, b), sign = -sign;
    out_.push_back({corner_[a], corner_[b], corner_[v]});
    clockwise_ |= sign<0, area_ |= sign> 0;
  }

  const std::vector<glm::dvec2>& p_;
  const std::vector<Index>& corner_;
  std::vector<Triangle>& out_;
  bool clockwise_ = false, area_ = false;
};

// Where the sweep line is inside the polygon: between an edge that runs to the right and one that runs to the
// left. Edge i goes from corner i to the next.
struct Region {
  Index lower = 0, upper = 0;
  Chain chain;          // of the whole region, or of what lies below the last merge
  Chain above;          // of what lies above it
  bool forked = false;  // nothing has come since that merge, so that its diagonal is not known yet
};

class Sweep {
 public:
  // No two neighbours of the ring are equal.
  Sweep(const std::vector<glm::dvec2>& ring, Cutter& cut)
      : p_(ring), cut_(cut), region_of_(ring.size()), order_(Below{*this}) {}

  void run() {
    for (const Event& event : sorted_events()) handle(event.corner, event.kind);
  }

 private:
  struct Event {
    glm::dvec2 place;
    Index corner;
    Kind kind;
  };
  // Regions from bottom to top. They do not overlap, so those that are there keep their order, and only
  // the one that corner now_ adds, newest_, has to be compared.
  struct Below {
    const Sweep& sweep;
    bool operator()(Index a, Index b) const {
      if (a == b) return false;
      if (b == sweep.newest_) return sweep.is_above(sweep.regions_[a].lower, sweep.now_);
      return !sweep.is_above(sweep.regions_[b].lower, sweep.now_);
    }
  };
  using Order = std::set<Index, Below>;

  Index next(Index i) const { return i + 1 == p_.size() ? 0 : i + 1; }
  Index previous(Index i) const { return i == 0 ? static_cast<Index>(p_.size()) - 1 : i - 1; }

  Kind kind(Index i) const {
    const bool from_left = before(p_[previous(i)], p_[i]), to_left = before(p_[next(i)], p_[i]);
    if (from_left != to_left) return from_left ? Kind::lower : Kind::upper;
    const bool reflex = cut_.turn(previous(i), i, next(i)) < 0;
    if (from_left) return reflex ? Kind::merge : Kind::end;
    return reflex ? Kind::split : Kind::start;
  }
  std::vector<Event> sorted_events() const {
    std::vector<Event> events(p_.size());
    for (Index i = 0; i < p_.size(); ++i) events[i] = {p_[i], i, kind(i)};
    std::sort(events.begin(), events.end(), [](const Event& a, const Event& b) {
      if (a.place != b.place) return before(a.place, b.place);
      return std::pair(a.kind, a.corner) < std::pair(b.kind, b.corner);
    });
    return events;
  }

  // Whether corner v, both of whose edges go to the right, begins above edge e, which runs to the right.
  // Where v touches e, its own edges tell: they do not cross e.
  bool is_above(Index e, Index v) const {
    for (const Index q : {v, next(v), previous(v)})
      if (const int side = cut_.turn(e, next(e), q); side != 0) return side > 0;
    return true;
  }

  void handle(Index v, Kind kind) {
    if (kind == Kind::lower) {
      const Index r = region_of_[previous(v)];
      set_lower(r, v);
      add(regions_[r], v, Side::lower);
    } else if (kind == Kind::upper) {
      const Index r = region_of_[v];
      set_upper(r, previous(v));
      add(regions_[r], v, Side::upper);
    } else if (kind == Kind::end || kind == Kind::merge) {
      close_or_merge(v);
    } else {
      open_or_split(v, kind);
    }
  }
  void set_lower(Index r, Index edge) { regions_[r].lower = edge, region_of_[edge] = r; }
  void set_upper(Index r, Index edge) { regions_[r].upper = edge, region_of_[edge] = r; }

  // A corner on the side of a region. The first after a merge takes the merge's diagonal, which ends the
  // part of its own side.
  void add(Region& r, Index v, Side side) {
    if (r.forked) {
      cut_.close(side == Side::lower ? r.chain : r.above, v);
      if (side == Side::lower) r.chain = std::move(r.above);
      r.above = {}, r.forked = false;
    }
    cut_.add(r.chain, v, side);
  }

  // The edges of v are the sides of one region, or the facing sides of two. No angle is asked: a spike
  // without width may be either.
  void close_or_merge(Index v) {
    const Index below = region_of_[v], above = region_of_[previous(v)];
    if (below == above) {
      Region& r = regions_[below];
      if (r.forked) cut_.close(r.above, v);
      cut_.close(r.chain, v);
      order_.erase(places_[below]);
      return;
    }
    add(regions_[below], v, Side::upper);
    add(regions_[above], v, Side::lower);
    regions_[below].above = std::move(regions_[above].chain);
    regions_[below].forked = true;
    set_upper(below, regions_[above].upper);
    order_.erase(places_[above]);
  }

  void open_or_split(Index v, Kind kind) {
    now_ = v, newest_ = static_cast<Index>(regions_.size());
    regions_.emplace_back();
    places_.push_back(order_.insert(newest_).first);
    set_lower(newest_, v);
    Region& fresh = regions_[newest_];
    if (places_.back() != order_.begin()) {
      const Index under = *std::prev(places_.back());
      if (kind == Kind::split || is_inside(regions_[under], v)) {
        set_upper(newest_, regions_[under].upper);
        set_upper(under, previous(v));
        split(regions_[under], fresh, v);
        return;
      }
    }
    set_upper(newest_, previous(v));
    fresh.chain.corners = {v};
  }
  // Whether v, which begins above the lower side of a region, is a spike without width into it.
  bool is_inside(const Region& r, Index v) const {
    return cut_.turn(previous(v), v, next(v)) == 0 && cut_.turn(next(r.upper), r.upper, v) < 0;
  }

  // Corner v is joined to the last corner before it: what lies above that diagonal becomes `fresh`.
  void split(Region& r, Region& fresh, Index v) {
    if (r.forked) {
      fresh.chain = std::move(r.above);
      r.above = {}, r.forked = false;
    } else {
      const Index last = r.chain.corners.back();
      const bool chain_is_above = r.chain.side == Side::lower;
      Chain& other = chain_is_above ? r.chain : fresh.chain;
      if (chain_is_above) fresh.chain = std::move(r.chain);
      other.corners = {last}, other.side = chain_is_above ? Side::upper : Side::lower;
    }
    cut_.add(fresh.chain, v, Side::lower);
    cut_.add(r.chain, v, Side::upper);
  }

  const std::vector<glm::dvec2>& p_;
  Cutter& cut_;
  std::vector<Region> regions_;  // all that ever were
  std::vector<Order::iterator> places_;
  std::vector<Index> region_of_;  // of an edge that the sweep line crosses
  Order order_;
  Index now_ = 0, newest_ = 0;
};

bool is_fan(std::span<const glm::dvec2> p) {
  for (std::size_t i = 1; i + 1 < p.size(); ++i)
    if (orientation(p[0], p[i], p[i + 1]) <= 0) return false;
  return true;
}

void append_fan(std::size_t n, std::vector<Triangle>& out) {
  for (Index i = 1; i + 1 < n; ++i) out.push_back({0, i, i + 1});
}

// The flat triangles between a corner and those that repeat it; `kept` is the last that repeats none.
void append_repeats(std::span<const glm::dvec2> corners, Index kept, std::vector<Triangle>& out) {
  const auto n = static_cast<Index>(corners.size());
  for (Index i = 0, before = n - 1; i < n; before = i++) {
    if (corners[i] == corners[before])
      out.push_back({kept, i, (i + 1) % n});
    else
      kept = i;
  }
}

}  // namespace

bool triangulate_polygon(std::span<const glm::dvec2> corners, std::vector<Triangle>& out) {
  const auto finite = [](const glm::dvec2& p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  const bool all_finite = std::all_of(corners.begin(), corners.end(), finite);
  if (!all_finite || is_fan(corners)) {
    append_fan(corners.size(), out);
    return all_finite;
  }
  const std::size_t n = corners.size(), had = out.size();
  std::vector<glm::dvec2> ring;
  std::vector<Index> corner;
  for (std::size_t i = 0; i < n; ++i) {
    if (corners[i] == corners[(i + n - 1) % n]) continue;
    ring.push_back(corners[i]), corner.push_back(static_cast<Index>(i));
  }
  Cutter cut(ring, corner, out);
  if (ring.size() > 2) {
    Sweep(ring, cut).run();
    append_repeats(corners, corner.back(), out);
  }
  if (out.size() == had + n - 2) return cut.some_area() && !cut.some_clockwise();
  out.resize(had);
  append_fan(n, out);
  return false;
}

}  // namespace frustum::kernels
