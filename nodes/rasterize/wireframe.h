// Edges of a mesh as lines on the screen: clip, divide, viewport, then distance to the line at every sample.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <span>
#include <vector>

#include "nodes/kernels/camera.h"
#include "nodes/kernels/clip.h"
#include "nodes/kernels/sample_positions.h"

namespace frustum::wireframe {

// Pixels and depth of both ends.
struct Line {
  glm::dvec3 a, b;
};

// The view volume, widened in x and y so that a line this far outside the picture is still there.
inline std::array<kernels::ClipPlane, 6> planes_around(const glm::ivec2& resolution, kernels::ClipSpace space,
                                                       double margin_px) {
  auto planes = kernels::view_volume(space);
  planes[2].bound = planes[3].bound = 1 + 2 * margin_px / resolution.x;
  planes[4].bound = planes[5].bound = 1 + 2 * margin_px / resolution.y;
  return planes;
}

// The part of the edge from p to q (clip space) inside all planes, on the screen; nothing where no part is,
// where w is not positive there, or where a number is not finite. An edge through the eye's plane ends at the
// near plane. Source: the parametric clip of Liang & Barsky 1984, in homogeneous coordinates (errata E12:
// before the divide).
inline std::optional<Line> line_of(const glm::dvec4& p, const glm::dvec4& q,
                                   const std::array<kernels::ClipPlane, 6>& planes,
                                   const kernels::Viewport& viewport) {
  double from = 0, to = 1;
  for (const kernels::ClipPlane& plane : planes) {
    const double d0 = kernels::clip_distance(plane, p), d1 = kernels::clip_distance(plane, q);
    if (!(d0 >= 0 || d1 >= 0)) return std::nullopt;  // also NaN
    if (d0 < 0) from = std::max(from, d0 / (d0 - d1));
    if (d1 < 0) to = std::min(to, d0 / (d0 - d1));
  }
  if (!(from <= to)) return std::nullopt;
  const auto at = [&](double t) {
    const glm::dvec4 h = t == 1 ? q : p + (q - p) * t;
    const glm::dvec3 ndc = kernels::divided(h);
    return std::pair{glm::dvec3(viewport.x_px(ndc.x), viewport.y_px(ndc.y), ndc.z), h.w > 0};
  };
  const auto [a, a_in_front] = at(from);
  const auto [b, b_in_front] = at(to);
  const double sum = (a.x + a.y + a.z) + (b.x + b.y + b.z);
  if (!a_in_front || !b_in_front || !std::isfinite(sum)) return std::nullopt;
  return Line{a, b};
}

// Lines by the square cells of the screen that they may touch, reach included.
class LineBins {
 public:
  static constexpr int cell = 32;  // px

  // `reach` is how far from its line a sample may be and still see it. Cells lie within [0, size).
  LineBins(std::vector<Line> lines, const glm::ivec2& size, double reach)
      : lines_(std::move(lines)),
        columns_((size.x + cell - 1) / cell),
        rows_((size.y + cell - 1) / cell),
        reach_(reach),
        first_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0) {
    for (const Line& line : lines_) each_cell(line, [&](std::size_t c) { ++first_[c + 1]; });
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    entries_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t i = 0; i < lines_.size(); ++i)
      each_cell(lines_[i], [&](std::size_t c) { entries_[next[c]++] = i; });
  }

  std::span<const std::uint32_t> of(int column, int row) const {
    const auto c = static_cast<std::size_t>(row * columns_ + column);
    return {entries_.data() + first_[c], first_[c + 1] - first_[c]};
  }
  const Line& line(std::uint32_t i) const { return lines_[i]; }
  std::size_t lines() const { return lines_.size(); }
  double reach() const { return reach_; }

  // The x of those points of the line that lie between y0 and y1, reach included on all sides; empty
  // (first > second) where there are none.
  std::pair<double, double> x_between(const Line& l, double y0, double y1) const {
    const double low = std::min(l.a.y, l.b.y), high = std::max(l.a.y, l.b.y);
    if (high < y0 - reach_ || low > y1 + reach_) return {1, 0};
    const double dy = l.b.y - l.a.y;
    double t0 = 0, t1 = 1;
    if (dy != 0) {
      const double ta = (y0 - reach_ - l.a.y) / dy, tb = (y1 + reach_ - l.a.y) / dy;
      t0 = std::clamp(std::min(ta, tb), 0.0, 1.0), t1 = std::clamp(std::max(ta, tb), 0.0, 1.0);
    }
    const double xa = l.a.x + (l.b.x - l.a.x) * t0, xb = l.a.x + (l.b.x - l.a.x) * t1;
    return {std::min(xa, xb) - reach_, std::max(xa, xb) + reach_};
  }

 private:
  static int cell_of(double px, int count) {
    return static_cast<int>(std::clamp(std::floor(px / cell), 0.0, count - 1.0));
  }

  template <class Body>
  void each_cell(const Line& l, const Body& body) const {
    const double low = std::min(l.a.y, l.b.y) - reach_, high = std::max(l.a.y, l.b.y) + reach_;
    if (high < 0 || low > rows_ * cell) return;
    for (int row = cell_of(low, rows_); row <= cell_of(high, rows_); ++row) {
      // A hair more than the cell, since rounding may put the crossing on its other side.
      const auto [x0, x1] = x_between(l, row * cell - 0.01, (row + 1) * cell + 0.01);
      if (x0 > x1 || x1 < 0 || x0 > columns_ * cell) continue;
      for (int column = cell_of(x0 - 0.01, columns_); column <= cell_of(x1 + 0.01, columns_); ++column)
        body(static_cast<std::size_t>(row * columns_ + column));
    }
  }

  std::vector<Line> lines_;
  int columns_, rows_;
  double reach_;
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> entries_;
};

// The point of a line nearest to a sample: how far it is (px), and its depth.
struct Nearest {
  double distance, z;
};
inline Nearest nearest(const Line& l, const glm::dvec2& p) {
  const glm::dvec2 a(l.a.x, l.a.y), d(l.b.x - l.a.x, l.b.y - l.a.y), e = p - a;
  const double length2 = d.x * d.x + d.y * d.y;
  const double t = length2 > 0 ? std::clamp((e.x * d.x + e.y * d.y) / length2, 0.0, 1.0) : 0;
  const glm::dvec2 off = e - d * t;
  return {std::sqrt(off.x * off.x + off.y * off.y), l.a.z + (l.b.z - l.a.z) * t};
}

// How much of a line of this width is seen at a distance from its middle. Several samples a pixel: all or
// nothing, and resolving them smooths. One: the overlap of the line with a pixel whose middle is that far
// from it, exact for lines along the pixels' rows and columns.
inline double coverage(double distance, double width, bool several_samples) {
  const double half = width / 2;
  if (several_samples) return distance <= half ? 1 : 0;
  return std::clamp(std::min(distance + 0.5, half) - std::max(distance - 0.5, -half), 0.0, 1.0);
}

// How much the depth of a face changes per pixel, at most; infinite for a face without area on the screen.
template <std::floating_point R>
double depth_slope(const glm::vec<4, R>& p, const glm::vec<4, R>& q, const glm::vec<4, R>& r) {
  const glm::dvec3 u = glm::dvec3(q) - glm::dvec3(p), v = glm::dvec3(r) - glm::dvec3(p);
  const double area = u.x * v.y - v.x * u.y;
  const double by_x = u.z * v.y - v.z * u.y, by_y = v.z * u.x - u.z * v.x;
  return std::sqrt(by_x * by_x + by_y * by_y) / std::fabs(area);
}

// Whether a line at depth z_line is behind a face whose depth is z_face at a sample `distance` px from the
// line. On the face's plane its depth may change by slope times distance on the way to the line; half a pixel
// more is granted for faces that bend, and 2^-22 for the rounding of float depths. So the faces that meet at
// an edge never hide it, and what is hidden can at most show where it is hidden by less than a pixel or so.
inline bool is_behind(double z_line, double z_face, double slope, double distance,
                      kernels::DepthRange depth) {
  const double slack = slope * (distance + 0.5) + 0x1p-22;
  return kernels::is_reversed(depth) ? z_line < z_face - slack : z_line > z_face + slack;
}

}  // namespace frustum::wireframe
