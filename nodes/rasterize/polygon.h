// Which samples lie in a polygon of any contours: winding numbers, exact on the grid of the triangles.
// Screen: x to the right, y down, in pixels; pixel (x, y) is the square [x, x+1) x [y, y+1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "nodes/kernels/area_coverage.h"
#include "nodes/kernels/sample_positions.h"

namespace frustum::polygon {

using kernels::GridPoint;

// A side from its upper to its lower end; winding 1 where the contour runs down, -1 where it runs up.
struct Side {
  kernels::Edge right;  // covers the samples on the side and to the right of it
  GridPoint top, bottom;
  int winding;
};

// The nearest point of the grid of 2^-8 px; nothing for NaN and beyond the triangles' limit.
inline std::optional<GridPoint> snapped(const glm::dvec2& px) {
  const double limit = kernels::corner_limit_px;
  if (!(std::fabs(px.x) <= limit && std::fabs(px.y) <= limit)) return std::nullopt;
  return GridPoint{kernels::snap(px.x, kernels::corner_bits), kernels::snap(px.y, kernels::corner_bits)};
}

// The sides of a closed contour. Horizontal ones separate no samples of a row and are left out.
inline void add_sides(std::vector<Side>& sides, std::span<const GridPoint> contour) {
  for (std::size_t i = 0; i < contour.size(); ++i) {
    const GridPoint &p = contour[i], &q = contour[i + 1 == contour.size() ? 0 : i + 1];
    if (p.y < q.y) sides.push_back({kernels::Edge(q, p), p, q, 1});
    if (q.y < p.y) sides.push_back({kernels::Edge(p, q), q, p, -1});
  }
}

// The same sides for the area of coverage: grid points are exact in double.
inline std::vector<kernels::AreaEdge> area_edges(std::span<const Side> sides) {
  const auto px = [](const GridPoint& p) { return glm::dvec2(p.x, p.y) / double{kernels::corner_unit}; };
  std::vector<kernels::AreaEdge> out;
  for (const Side& s : sides) out.push_back({px(s.top), px(s.bottom), s.winding});
  return out;
}

// Winding numbers row by row. A side counts for the samples on it and to its right, from its upper end on to
// before its lower one: the triangles' top-left rule, so that polygons which share sides share no sample and
// leave none out, and a triangle covers what rasterize.triangles says it does.
class WindingRows {
 public:
  // Rows are asked for from the top. Requires |x|, |y| <= 2^16 in the window.
  WindingRows(std::vector<Side> sides, const kernels::SamplePositions& pattern, kernels::PixelRect window)
      : sides_(std::move(sides)),
        pattern_(pattern),
        window_(window),
        width_(static_cast<std::size_t>(window.x1 - window.x0)),
        step_(static_cast<std::size_t>(pattern.samples) * width_),
        whole_(step_ + 1),
        phased_(step_ + 1) {
    std::sort(sides_.begin(), sides_.end(), [](const Side& a, const Side& b) { return a.top.y < b.top.y; });
  }

  std::size_t active() const { return active_.size(); }

  // The winding number at [sample][x - window.x0] of row y; `out` has samples x width elements.
  // Cost: sides of the row times the pixels that each crosses there; a side that ends in the row also times
  // the pattern's period.
  void row(int y, std::span<int> out) {
    const auto row_top = std::int64_t{y} * kernels::corner_unit, row_end = row_top + kernels::corner_unit;
    std::erase_if(active_, [&](const Side* s) { return s->bottom.y <= row_top; });
    for (; next_ < sides_.size() && sides_[next_].top.y < row_end; ++next_)
      if (sides_[next_].bottom.y > row_top) active_.push_back(&sides_[next_]);
    std::fill(out.begin(), out.end(), 0);
    if (active_.empty()) return;
    std::fill(whole_.begin(), whole_.end(), 0);
    std::fill(phased_.begin(), phased_.end(), 0);
    for (const Side* s : active_) add(*s, y, row_top, row_end, out);
    const auto period = static_cast<std::size_t>(pattern_.period);
    for (std::size_t k = 0; k < static_cast<std::size_t>(pattern_.samples); ++k) {
      int sum = 0;
      for (std::size_t x = 0; x < width_; ++x) {
        const std::size_t i = k * width_ + x;
        sum += whole_[i];
        if (x >= period) phased_[i] += phased_[i - period];
        out[i] += sum + phased_[i];
      }
    }
  }

 private:
  // The columns [first, last) of the window that a side may cross in a row.
  std::pair<int, int> crossed(const Side& s, std::int64_t row_top, std::int64_t row_end) const {
    const double height = static_cast<double>(s.bottom.y) - s.top.y;
    const auto x_at = [&](std::int64_t y) {
      const double t = std::clamp((static_cast<double>(y) - s.top.y) / height, 0.0, 1.0);
      return (s.top.x + (static_cast<double>(s.bottom.x) - s.top.x) * t) / kernels::corner_unit;
    };
    const double a = x_at(row_top), b = x_at(row_end);
    // A pixel more on both sides than double may be off by.
    const double low =
        std::clamp(std::floor(std::min(a, b)) - 1, double{1} * window_.x0, double{1} * window_.x1);
    const double high =
        std::clamp(std::floor(std::max(a, b)) + 2, double{1} * window_.x0, double{1} * window_.x1);
    return {static_cast<int>(low), static_cast<int>(high)};
  }

  bool in_rows(const Side& s, int k, int x, int y) const {
    constexpr std::int64_t scale = kernels::sample_unit / kernels::corner_unit;
    const std::int64_t at = std::int64_t{y} * kernels::sample_unit + pattern_.y[pattern_.index(k, x, y)];
    return s.top.y * scale <= at && at < s.bottom.y * scale;
  }

  void add(const Side& s, int y, std::int64_t row_top, std::int64_t row_end, std::span<int> out) {
    const auto [first, last] = crossed(s, row_top, row_end);
    const bool spans_row = s.top.y <= row_top && s.bottom.y >= row_end;
    for (int k = 0; k < pattern_.samples; ++k) {
      const std::size_t base = static_cast<std::size_t>(k) * width_;
      const auto at = [&](int x) { return base + static_cast<std::size_t>(x - window_.x0); };
      for (int x = first; x < last; ++x) {
        const std::size_t i = pattern_.index(k, x, y);
        if (in_rows(s, k, x, y) &&
            kernels::Edge::covers(s.right.at_pixel(x, y), s.right.at_offset(pattern_.x[i], pattern_.y[i])))
          out[at(x)] += s.winding;
      }
      if (last >= window_.x1) continue;
      if (spans_row) {
        whole_[at(last)] += s.winding;
        continue;
      }
      const int end = std::min(last + pattern_.period, window_.x1);
      for (int x = last; x < end; ++x)
        if (in_rows(s, k, x, y)) phased_[at(x)] += s.winding;
    }
  }

  std::vector<Side> sides_;
  kernels::SamplePositions pattern_;
  kernels::PixelRect window_;
  std::size_t width_, step_;
  std::vector<int> whole_, phased_;  // what changes from a pixel on: for all, and for those a period apart
  std::vector<const Side*> active_;
  std::size_t next_ = 0;
};

}  // namespace frustum::polygon
