#pragma once
// How much of each pixel a polygon covers, exactly: for any number of contours that may cross themselves.
// Screen: x to the right, y down; pixel (x, y) is the square [x, x+1) x [y, y+1).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "nodes/kernels/bin_triangles.h"

namespace frustum::kernels {

// Which winding numbers are inside: odd ones, or all but zero.
enum class FillRule : std::uint8_t { even_odd, nonzero };
constexpr bool is_inside(int winding, FillRule rule) {
  return rule == FillRule::even_odd ? (winding & 1) != 0 : winding != 0;
}

// A side of a polygon from its upper to its lower end (top.y < bottom.y); `winding` is what crossing it from
// left to right adds: 1 where the contour runs down, -1 where it runs up. Two polygons that share a side so
// have the same one, and their shares of a pixel add up.
struct AreaEdge {
  glm::dvec2 top, bottom;
  int winding;

  // The x at a y between the ends; exactly the end's own at an end.
  double x_at(double y) const {
    if (y <= top.y) return top.x;
    if (y >= bottom.y) return bottom.x;
    return top.x + (y - top.y) * ((bottom.x - top.x) / (bottom.y - top.y));
  }
};

// The sides of a closed contour; those along a row of pixels bound no area and are left out.
inline void add_edges(std::vector<AreaEdge>& edges, std::span<const glm::dvec2> contour) {
  for (std::size_t i = 0; i < contour.size(); ++i) {
    const glm::dvec2 &p = contour[i], &q = contour[i + 1 == contour.size() ? 0 : i + 1];
    if (p.y < q.y) edges.push_back({p, q, 1});
    if (q.y < p.y) edges.push_back({q, p, -1});
  }
}

// Sweeps bands between all y where an end, a crossing or a row of pixels lies. Within a band sides do not
// cross, so what lies inside is trapezoids, each taken from the pixels in closed form.
class AreaSweep {
 public:
  // Requires finite coordinates.
  AreaSweep(std::vector<AreaEdge> edges, FillRule rule, PixelRect window)
      : edges_(std::move(edges)),
        rule_(rule),
        window_(window),
        cell_(static_cast<std::size_t>(window.x1 - window.x0)),
        full_(cell_.size() + 1) {
    std::sort(edges_.begin(), edges_.end(),
              [](const AreaEdge& a, const AreaEdge& b) { return a.top.y < b.top.y; });
  }

  // Calls row(y, shares) for the rows of the window, from the top, that a side reaches into; shares[i] in [0, 1]
  // is the covered area of pixel window.x0 + i. Error: a few u per side in the pixel, and 0 for pixels that
  // are wholly inside or outside where the coordinates are dyadic. Cost: bands times the sides in them.
  template <class Row>
  void rows(const Row& row) {
    double y = window_.y0;
    while (y < window_.y1) {
      enter(y);
      const double row_end = std::min(std::floor(y) + 1, static_cast<double>(window_.y1));
      if (active_.empty()) {
        const bool done = next_ == edges_.size();
        if (done || edges_[next_].top.y >= row_end) flush(y, row);
        if (done) return;
        const double top = edges_[next_].top.y;
        y = top >= row_end ? std::floor(top) : top;
        continue;
      }
      double end = row_end;
      if (next_ < edges_.size()) end = std::min(end, edges_[next_].top.y);
      for (const AreaEdge* e : active_) end = std::min(end, e->bottom.y);
      band(y, end);
      touched_ = true;
      if (end == row_end) flush(y, row);
      y = end;
    }
  }

 private:
  struct Side {
    double x0, x1;  // at the upper and the lower end of the band
    int winding;
  };

  void enter(double y) {
    std::erase_if(active_, [&](const AreaEdge* e) { return e->bottom.y <= y; });
    for (; next_ < edges_.size() && edges_[next_].top.y <= y; ++next_)
      if (edges_[next_].bottom.y > y) active_.push_back(&edges_[next_]);
  }

  template <class Row>
  void flush(double y, const Row& row) {
    if (!touched_) return;
    touched_ = false;
    double sum = 0;
    for (std::size_t i = 0; i < cell_.size(); ++i) {
      sum += full_[i];
      const double share = sum + cell_[i];
      cell_[i] = share < 0 ? 0 : std::min(share, 1.0);
    }
    row(static_cast<int>(std::floor(y)), std::span<const double>(cell_));
    std::fill(cell_.begin(), cell_.end(), 0.0);
    std::fill(full_.begin(), full_.end(), 0.0);
  }

  void band(double y0, double y1) {
    sides_.clear();
    for (const AreaEdge* e : active_) sides_.push_back({e->x_at(y0), e->x_at(y1), e->winding});
    std::sort(sides_.begin(), sides_.end(),
              [](const Side& a, const Side& b) { return a.x0 != b.x0 ? a.x0 < b.x0 : a.x1 < b.x1; });
    const bool crossing = !std::is_sorted(sides_.begin(), sides_.end(),
                                          [](const Side& a, const Side& b) { return a.x1 < b.x1; });
    if (!crossing) return add_inside(y1 - y0, sides_);
    cut(y0, y1);
  }

  // Cuts a band where its sides cross, at shares of its height. Putting the sides, in order at the upper end,
  // into that of the lower end by insertion meets every pair that crosses once, and no other.
  void cut(double y0, double y1) {
    cuts_.assign({0.0, 1.0});
    part_.assign(sides_.begin(), sides_.end());
    for (std::size_t i = 1; i < part_.size(); ++i)
      for (std::size_t k = i; k > 0 && part_[k - 1].x1 > part_[k].x1; --k) {
        const double above = part_[k].x0 - part_[k - 1].x0, below = part_[k].x1 - part_[k - 1].x1;
        cuts_.push_back(above / (above - below));
        std::swap(part_[k - 1], part_[k]);
      }
    std::sort(cuts_.begin(), cuts_.end());
    const auto x = [](const Side& s, double t) { return t == 1 ? s.x1 : s.x0 + (s.x1 - s.x0) * t; };
    for (std::size_t c = 1; c < cuts_.size(); ++c) {
      const double t0 = cuts_[c - 1], t1 = cuts_[c];
      if (!(t0 < t1)) continue;
      part_.clear();
      for (const Side& s : sides_) part_.push_back({x(s, t0), x(s, t1), s.winding});
      std::sort(part_.begin(), part_.end(),
                [](const Side& a, const Side& b) { return a.x0 + a.x1 < b.x0 + b.x1; });
      add_inside((y1 - y0) * (t1 - t0), part_);
    }
  }

  void add_inside(double height, std::span<const Side> sides) {
    int winding = 0;
    for (const Side& s : sides) {
      const bool before = is_inside(winding, rule_);
      winding += s.winding;
      const bool after = is_inside(winding, rule_);
      if (before != after) add_right_of(s, after ? height : -height);
    }
  }

  // Adds the area of the band to the right of a side. Of a pixel at distance v from the side's left end, the
  // part T(v) = clamp((v - left) / (right - left)) of the height is to its right; this is the integral of T.
  void add_right_of(const Side& s, double height) {
    const double left = std::min(s.x0, s.x1) - window_.x0, right = std::max(s.x0, s.x1) - window_.x0;
    const auto n = static_cast<double>(cell_.size());
    if (left >= n) return;
    const double first = std::clamp(std::floor(left), 0.0, n), last = std::clamp(std::ceil(right), 0.0, n);
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      const double l = left - static_cast<double>(i), r = right - static_cast<double>(i);
      const double u0 = std::clamp(l, 0.0, 1.0), u1 = std::clamp(r, 0.0, 1.0);
      const double slanted = u1 > u0 ? (u1 - u0) * (((u0 + u1) / 2 - l) / (r - l)) : 0;
      cell_[i] += height * (slanted + (1 - u1));
    }
    full_[static_cast<std::size_t>(last)] += height;
  }

  std::vector<AreaEdge> edges_;
  FillRule rule_;
  PixelRect window_;
  std::vector<double> cell_, full_;  // of the current row: partly covered, and from there on to the right
  std::vector<const AreaEdge*> active_;
  std::vector<Side> sides_, part_;
  std::vector<double> cuts_;
  std::size_t next_ = 0;
  bool touched_ = false;
};

}  // namespace frustum::kernels
