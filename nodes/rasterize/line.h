// Segments as pixels, by the textbook's ways of drawing a line.
// Screen: x to the right, y down, in pixels; pixel (x, y) is the square [x, x+1) x [y, y+1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <glm/vec2.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "nodes/kernels/area_coverage.h"
#include "nodes/kernels/elementary.h"
#include "nodes/kernels/vector.h"

namespace frustum::line {

__extension__ using Wide = __int128;

// Ends lie on a grid of 2^-8 px and at most 2^30 px from the corner of the screen, so that a coordinate has
// 39 bits, a product of two 78, and a decision variable 49.
inline constexpr int grid_bits = 8;
inline constexpr std::int64_t grid = 1 << grid_bits, half = grid / 2;
inline constexpr double limit_px = 0x1p30;

struct GridPoint {
  std::int64_t x, y;
};

// The nearest grid point, halves away from zero; nothing for NaN and beyond the limit.
inline std::optional<GridPoint> snapped(const glm::dvec2& px) {
  if (!(std::fabs(px.x) <= limit_px && std::fabs(px.y) <= limit_px)) return std::nullopt;
  return GridPoint{std::llround(px.x * grid), std::llround(px.y * grid)};
}

enum class Ends : std::uint8_t {
  closed,  // from the pixel that holds the one end to the pixel that holds the other
  diamond  // the pixels whose diamond |x| + |y| < 1/2 about the middle the segment leaves
};
enum class Ties : std::uint8_t {
  fixed,  // a line midway between two pixels takes the one below or to the right, whichever way it runs
  stay    // it keeps its row, as the course's code does, so that the reversed line may differ
};

// A pixel of a line; what `decision` is depends on the algorithm.
struct Step {
  int x, y;
  double decision, coverage;
};

inline std::int64_t floor_div(std::int64_t a, std::int64_t b) { return a / b - (a % b < 0 ? 1 : 0); }
inline Wide floor_div(Wide a, Wide b) { return a / b - (a % b < 0 ? 1 : 0); }  // b > 0

// A segment in the frame of its longer axis: `a` runs along it, `b` across. Columns are pixels along a, rows
// pixels along b. The exact b at the middle of column k is numerator(k) / length, in grid steps.
class Walk {
 public:
  Walk(GridPoint from, GridPoint to)
      : steep_(std::llabs(to.y - from.y) > std::llabs(to.x - from.x)),
        a0_(steep_ ? from.y : from.x),
        b0_(steep_ ? from.x : from.y),
        a1_(steep_ ? to.y : to.x),
        b1_(steep_ ? to.x : to.y),
        dir_(a1_ >= a0_ ? 1 : -1),
        side_(b1_ >= b0_ ? 1 : -1),
        length_(std::llabs(a1_ - a0_)),
        rise_(std::llabs(b1_ - b0_)) {}

  bool steep() const { return steep_; }
  int dir() const { return dir_; }
  int side() const { return side_; }  // the way rows go
  std::int64_t length() const { return length_; }
  std::int64_t rise() const { return rise_; }
  std::int64_t a0() const { return a0_; }
  std::int64_t a1() const { return a1_; }
  std::int64_t b0() const { return b0_; }
  std::int64_t b1() const { return b1_; }

  static std::int64_t pixel_of(std::int64_t coordinate) { return floor_div(coordinate, grid); }
  static std::int64_t middle(std::int64_t pixel) { return pixel * grid + half; }

  Wide numerator(std::int64_t column) const {
    return Wide{b0_} * length_ + Wide{(middle(column) - a0_) * dir_} * rise_ * side_;
  }
  // The row whose middle is nearest to the line in the middle of a column.
  std::int64_t row(std::int64_t column, Ties ties) const {
    if (length_ == 0) return pixel_of(b0_);
    const Wide n = numerator(column), d = Wide{length_} * grid;
    const bool keep = ties == Ties::stay && rise_ > 0 && side_ > 0;
    return static_cast<std::int64_t>(keep ? floor_div(n - 1, d) : floor_div(n, d));
  }

  // Whether an end lies in the diamond of the pixel that the line meets in the column of that end.
  bool in_diamond(std::int64_t a, std::int64_t b, std::int64_t column) const {
    return std::llabs(a - middle(column)) + std::llabs(b - middle(row(column, Ties::fixed))) < half;
  }

  // The first and the last column that are drawn, in the order of the walk; nothing where none is.
  // A line no steeper than its diamonds' sides crosses those of the columns between its ends in their middle;
  // before and beyond it, it can neither enter nor leave one.
  std::optional<std::pair<std::int64_t, std::int64_t>> columns(Ends ends) const {
    std::int64_t first = pixel_of(a0_), last = pixel_of(a1_);
    if (ends == Ends::closed) return std::pair{first, last};
    const bool starts = dir_ * (middle(first) - a0_) >= 0 || in_diamond(a0_, b0_, first);
    const bool leaves = dir_ * (a1_ - middle(last)) > 0 && !in_diamond(a1_, b1_, last);
    if (first == last && (!starts || !leaves)) return std::nullopt;
    if (!starts) first += dir_;
    if (!leaves) last -= dir_;
    if (dir_ * (last - first) < 0) return std::nullopt;
    return std::pair{first, last};
  }

 private:
  bool steep_;
  std::int64_t a0_, b0_, a1_, b1_;
  int dir_, side_;
  std::int64_t length_, rise_;
};

// Columns and rows of the window, `grown` pixels wider.
struct Bounds {
  std::int64_t first_column, last_column, first_row, last_row;
  Bounds(const kernels::PixelRect& w, bool steep, int grown)
      : first_column((steep ? w.y0 : w.x0) - grown),
        last_column((steep ? w.y1 : w.x1) - 1 + grown),
        first_row((steep ? w.x0 : w.y0) - grown),
        last_row((steep ? w.x1 : w.y1) - 1 + grown) {}
};

// The part of the columns [first, last] whose rows lie within the bounds, found without walking there: rows
// never go back, so the first is found by halving. Exact: what is drawn is what the whole line would draw.
inline std::optional<std::pair<std::int64_t, std::int64_t>> visible(
    const Walk& w, std::pair<std::int64_t, std::int64_t> columns, const Bounds& bounds, Ties ties) {
  const int dir = w.dir();
  const std::int64_t enter = dir > 0 ? bounds.first_column : bounds.last_column;
  const std::int64_t leave = dir > 0 ? bounds.last_column : bounds.first_column;
  std::int64_t first = dir * (columns.first - enter) > 0 ? columns.first : enter;
  std::int64_t last = dir * (columns.second - leave) < 0 ? columns.second : leave;
  if (dir * (last - first) < 0) return std::nullopt;
  const auto reached = [&](std::int64_t column, bool past) {
    const std::int64_t row = w.row(column, ties);
    if (w.side() > 0) return past ? row > bounds.last_row : row >= bounds.first_row;
    return past ? row < bounds.first_row : row <= bounds.last_row;
  };
  // The number of columns from `first` on for which reached() does not hold yet.
  const auto before = [&](bool past) {
    std::int64_t low = 0, high = dir * (last - first) + 1;
    while (low < high) {
      const std::int64_t middle = low + (high - low) / 2;
      if (reached(first + dir * middle, past))
        high = middle;
      else
        low = middle + 1;
    }
    return low;
  };
  const std::int64_t skip = before(false), end = before(true);
  if (skip >= end) return std::nullopt;
  last = first + dir * (end - 1);
  first += dir * skip;
  return std::pair{first, last};
}

template <class Visit>
void visit_pixel(const Walk& w, std::int64_t column, std::int64_t row, double decision, double coverage,
                 const kernels::PixelRect& window, const Visit& visit) {
  const std::int64_t x = w.steep() ? row : column, y = w.steep() ? column : row;
  if (x < window.x0 || x >= window.x1 || y < window.y0 || y >= window.y1) return;
  visit(Step{static_cast<int>(x), static_cast<int>(y), decision, coverage});
}

// One pixel in every column, the one whose middle is nearest to the line: exact, whatever the octant.
// `decision` is d = 2 F at the point midway between the two pixels that may come next, in the units of the
// course: 2 dy - dx at the start of a line between pixel middles; the line steps aside where it is above 0.
// Cost: O(pixels drawn + 40 for a line that begins outside). Source: Bresenham 1965, IBM Systems Journal 4:25;
// the midpoint form of Pitteway 1967; errata E14 to E17.
template <class Visit>
void bresenham(GridPoint from, GridPoint to, Ends ends, Ties ties, const kernels::PixelRect& window,
               const Visit& visit) {
  const Walk w(from, to);
  const auto columns = w.columns(ends);
  if (!columns) return;
  const auto seen = visible(w, *columns, Bounds(window, w.steep(), 0), ties);
  if (!seen) return;
  std::int64_t column = seen->first, row = w.row(column, ties);
  // The line's distance beyond the middle of the two rows in the next column, times length, in grid steps.
  const std::int64_t side = w.side(), boundary = (row + (side > 0 ? 1 : 0)) * grid;
  auto beyond =
      static_cast<std::int64_t>((w.numerator(column + w.dir()) - Wide{boundary} * w.length()) * side);
  const std::int64_t along = grid * w.rise(), across = grid * w.length();
  const bool tie_steps = ties == Ties::fixed && side > 0;
  for (;; column += w.dir()) {
    visit_pixel(w, column, row, 2 * static_cast<double>(beyond) / (grid * grid), 1.0, window, visit);
    if (column == seen->second) return;
    if (beyond > 0 || (beyond == 0 && tie_steps)) row += side, beyond -= across;
    beyond += along;
  }
}

// The same pixels by one multiplication and one addition a column, in double: a row differs from the exact one
// only where the line passes within 3 u |b| of the point midway. (Adding the slope again and again instead
// puts every tenth pixel of a line of 16384 wrong in single precision.) `decision`: the line's coordinate.
template <class Visit>
void dda(GridPoint from, GridPoint to, Ends ends, const kernels::PixelRect& window, const Visit& visit) {
  const Walk w(from, to);
  const auto columns = w.columns(ends);
  if (!columns) return;
  const auto seen = visible(w, *columns, Bounds(window, w.steep(), 1), Ties::fixed);
  if (!seen) return;
  constexpr double unit = 1.0 / grid;
  const double b0 = static_cast<double>(w.b0()) * unit;
  const double slope =
      w.length() == 0 ? 0 : static_cast<double>(w.b1() - w.b0()) / static_cast<double>(w.a1() - w.a0());
  for (std::int64_t column = seen->first;; column += w.dir()) {
    const double b = b0 + static_cast<double>(Walk::middle(column) - w.a0()) * unit * slope;
    visit_pixel(w, column, static_cast<std::int64_t>(std::floor(b)), b, 1.0, window, visit);
    if (column == seen->second) return;
  }
}

// Two pixels a column that share one unit of ink by their distance across; at the ends times the part of the
// column that the line passes. `decision`: the share of the second. Source: Wu 1991, SIGGRAPH 25(4):143.
template <class Visit>
void wu(GridPoint from, GridPoint to, const kernels::PixelRect& window, const Visit& visit) {
  const Walk w(from, to);
  if (w.length() == 0) return;
  const auto seen = visible(w, *w.columns(Ends::closed), Bounds(window, w.steep(), 1), Ties::fixed);
  if (!seen) return;
  const std::int64_t low = std::min(w.a0(), w.a1()), high = std::max(w.a0(), w.a1());
  const Wide unit = Wide{w.length()} * grid;
  for (std::int64_t column = seen->first;; column += w.dir()) {
    const Wide n = w.numerator(column) - Wide{w.length()} * half;
    const auto row = static_cast<std::int64_t>(floor_div(n, unit));
    const double share = static_cast<double>(n - unit * row) / static_cast<double>(unit);
    const std::int64_t begin = std::max(low, column * grid), end = std::min(high, (column + 1) * grid);
    const double passed = static_cast<double>(std::max<std::int64_t>(end - begin, 0)) / grid;
    if (passed > 0) {
      visit_pixel(w, column, row, share, (1 - share) * passed, window, visit);
      if (share > 0) visit_pixel(w, column, row + 1, share, share * passed, window, visit);
    }
    if (column == seen->second) return;
  }
}

// The part of a cone of volume 1 over the unit disc that lies beyond the line x = h.
// Integrating the sections sqrt(1 - x^2) - x^2 arsech x gives (acos h - 2 h s + h^3 arsech h) / pi.
inline double cone_beyond(double h) {
  if (h >= 1) return 0;
  if (h < 0) return 1 - cone_beyond(-h);
  const double s = std::sqrt((1 - h) * (1 + h));
  const double inverse = h > 0 ? kernels::log((1 + s) / h) : 0;
  return (kernels::acos(h) - 2 * h * s + h * h * h * inverse) / 3.141592653589793;
}

// What a cone of radius 1 px sees of a stripe of a width, its middle `distance` px from the cone's.
inline double cone_coverage(double distance, double width) {
  return std::max(0.0, cone_beyond(distance - width / 2) - cone_beyond(distance + width / 2));
}

// Every pixel near the segment by its distance from it through a cone of radius 1 px; the ends are round.
// `decision`: that distance (px), within 2 ulp, from exact products. The cone is integrated and not looked up.
// Source: Gupta & Sproull 1981, SIGGRAPH 15(3):1.
template <class Visit>
void gupta_sproull(GridPoint from, GridPoint to, double width, const kernels::PixelRect& window,
                   const Visit& visit) {
  const Walk w(from, to);
  const double reach = 1 + width / 2;
  // A point of the line lies within sqrt(2) reach of the pixel, counted along its column.
  const auto rows = static_cast<int>(std::ceil(reach * 1.4142135623730951)) + 1;
  const auto more = static_cast<std::int64_t>(std::ceil(reach));
  const auto ends = *w.columns(Ends::closed);
  const auto seen = visible(w, {ends.first - w.dir() * more, ends.second + w.dir() * more},
                            Bounds(window, w.steep(), rows), Ties::fixed);
  if (!seen) return;
  const std::int64_t da = w.a1() - w.a0(), db = w.b1() - w.b0();
  const double length = kernels::norm(glm::dvec2(static_cast<double>(da), static_cast<double>(db)));
  const auto distance = [&](std::int64_t a, std::int64_t b) {
    const auto from_point = [](std::int64_t u, std::int64_t v) {
      return kernels::norm(glm::dvec2(static_cast<double>(u), static_cast<double>(v))) / grid;
    };
    const Wide along = Wide{a - w.a0()} * da + Wide{b - w.b0()} * db;
    if (length == 0 || along <= 0) return from_point(a - w.a0(), b - w.b0());
    if (along >= Wide{da} * da + Wide{db} * db) return from_point(a - w.a1(), b - w.b1());
    const Wide across = Wide{a - w.a0()} * db - Wide{b - w.b0()} * da;
    return std::fabs(static_cast<double>(across)) / length / grid;
  };
  for (std::int64_t column = seen->first;; column += w.dir()) {
    const std::int64_t middle = w.row(column, Ties::fixed);
    for (std::int64_t row = middle - rows; row <= middle + rows; ++row) {
      const double d = distance(Walk::middle(column), Walk::middle(row));
      const double coverage = d < reach ? cone_coverage(d, width) : 0;
      if (coverage > 0) visit_pixel(w, column, row, d, coverage, window, visit);
    }
    if (column == seen->second) return;
  }
}

// The area that the segment, as a rectangle of a width with square ends, covers of each pixel. `decision`: 0.
// Error: a few u where the ends lie within some thousand pixels.
template <class Visit>
void exact_area(GridPoint from, GridPoint to, double width, const kernels::PixelRect& window,
                const Visit& visit) {
  const auto px = [](GridPoint p) {
    return glm::dvec2(static_cast<double>(p.x), static_cast<double>(p.y)) / static_cast<double>(grid);
  };
  const glm::dvec2 p = px(from), q = px(to);
  const auto along = kernels::normalized(q - p);
  if (!along) return;
  const glm::dvec2 aside = glm::dvec2(-along->y, along->x) * (width / 2);
  std::vector<kernels::AreaEdge> edges;
  const glm::dvec2 corners[] = {p - aside, q - aside, q + aside, p + aside};
  kernels::add_edges(edges, corners);
  kernels::AreaSweep sweep(std::move(edges), kernels::FillRule::nonzero, window);
  sweep.rows([&](int y, std::span<const double> shares) {
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (shares[i] > 0) visit(Step{window.x0 + static_cast<int>(i), y, 0, shares[i]});
  });
}

}  // namespace frustum::line
