// Where to cut a curve so that straight lines stay near it, with a bound on how far they leave it.
//
// A Bezier polynomial of degree n stays within n (n - 1) / 8 max|P_i+2 - 2 P_i+1 + P_i| of the chord,
// parameter by parameter: |P''| is at most n (n - 1) of those differences, and a chord over [0, 1] errs by
// at most |P''| / 8. Halving a piece quarters the bound, so that log4(bound / tolerance) halvings are
// enough; nothing is divided by a chord's length, which may be 0. A rational piece lies in the hull of its
// control points, and so within the largest of their distances from the chord.
// Source: Wang 1984, Shanghai Univ. of Sci. & Tech. 1:6; Filip, Magedson & Markot 1986, CAGD 3:295.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/spline.h"
#include "nodes/kernels/vector.h"

namespace frustum::polyline {

// The distance of q from the segment a b.
inline double distance_to_segment(const glm::dvec3& q, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length = kernels::norm(along);
  if (!(length > 0)) return kernels::norm(q - a);
  const glm::dvec3 unit = along / length;
  const double at = std::clamp(kernels::dot(q - a, unit), 0.0, length);
  return std::min({kernels::norm((q - a) - unit * at), kernels::norm(q - a), kernels::norm(q - b)});
}

// How far the Bezier piece of these homogeneous points may be from its chord. NaN where a point is not
// finite. A point without a weight does not count. Where a weight is below 0 there is no hull to stay in,
// and the bound is the largest number; parts of a curve whose denominator is above 0 come to have none
// such.
inline double deviation_bound(std::span<const glm::dvec4> h, bool rational) {
  const std::size_t n = h.size() - 1;
  double bound = 0;
  const auto raise = [&bound](double x) { bound = bound >= x ? bound : x; };  // takes NaN in
  if (!rational) {
    const double factor = static_cast<double>(n) * (static_cast<double>(n) - 1) / 8;
    for (std::size_t i = 0; i + 2 <= n; ++i)
      raise(factor * kernels::norm(glm::dvec3((h[i + 2] - h[i + 1]) - (h[i + 1] - h[i]))));
    return bound;
  }
  std::vector<glm::dvec3> p;
  for (const glm::dvec4& q : h) {
    if (q.w < 0) return std::numeric_limits<double>::max();
    if (q.w != 0) p.push_back(glm::dvec3(q) / q.w);
  }
  for (const glm::dvec3& q : p) raise(distance_to_segment(q, p.front(), p.back()));
  return bound;
}

// Both halves of a Bezier piece by repeated midpoints; the point between them is the same in both.
inline std::pair<std::vector<glm::dvec4>, std::vector<glm::dvec4>> halves(std::vector<glm::dvec4> d) {
  const std::size_t n = d.size() - 1;
  std::vector<glm::dvec4> left{d.front()};
  for (std::size_t level = 1; level <= n; ++level) {
    for (std::size_t i = 0; i + level <= n; ++i) d[i] = d[i] * 0.5 + d[i + 1] * 0.5;
    left.push_back(d[0]);
  }
  return {std::move(left),
          std::move(d)};  // what is left of d are the last points of all levels, from last to first
}

struct Cut {
  double from, to;  // parameters
  double bound;     // on the chord's deviation
};

// Cuts one Bezier piece over [from, to] until each bound is at most the tolerance, at most `depth` times in
// two, and hands the parts to visit(Cut) in order. The bound of a part may stay above it only at that
// depth, or where it is no number.
template <class Visit>
void cut_adaptively(const std::vector<glm::dvec4>& piece, bool rational, Cut part, double tolerance,
                    int depth, const Visit& visit) {
  part.bound = deviation_bound(piece, rational);
  const double middle = part.from + (part.to - part.from) / 2;
  const bool divisible = part.from < middle && middle < part.to;
  if (part.bound <= tolerance || depth == 0 || !divisible || !std::isfinite(part.bound)) return visit(part);
  const auto [left, right] = halves(piece);
  cut_adaptively(left, rational, {part.from, middle, 0}, tolerance, depth - 1, visit);
  cut_adaptively(right, rational, {middle, part.to, 0}, tolerance, depth - 1, visit);
}

// Cuts a span into equal parts.
template <class Visit>
void cut_uniformly(const kernels::Spline& s, std::size_t span, int parts, const Visit& visit) {
  const double a = s.knots[span], b = s.knots[span + 1];
  const auto at = [&](int k) {
    const double along = static_cast<double>(k) / parts, away = static_cast<double>(parts - k) / parts;
    return kernels::mixed(a, b, away, along);
  };
  for (int k = 0; k < parts; ++k)
    visit(Cut{at(k), at(k + 1),
              deviation_bound(kernels::bezier_points(s, span, at(k), at(k + 1)), s.rational())});
}

// Unit tangent in the direction of travel, along the first derivative that does not vanish there;
// derivatives of even order point against it where the curve comes to a stand, at the end of a piece. Zero
// where none is left.
// Source: Farin, "Curves and Surfaces for CAGD", section 5.
inline glm::dvec3 tangent(std::span<const glm::dvec3> derivatives, kernels::KnotSide side) {
  for (std::size_t order = 1; order <= derivatives.size(); ++order)
    if (const auto unit = kernels::normalized(derivatives[order - 1]))
      return side == kernels::KnotSide::before && order % 2 == 0 ? -*unit : *unit;
  return glm::dvec3(0);
}

// |P' x P''| / |P'|^3; 0 where the curve stands still.
inline double curvature(const glm::dvec3& first, const glm::dvec3& second) {
  const double speed = kernels::norm(first);
  if (!(speed > 0)) return 0;
  const glm::dvec3 unit = first / speed;
  return kernels::norm(kernels::cross(unit, second / speed)) / speed;
}

}  // namespace frustum::polyline
