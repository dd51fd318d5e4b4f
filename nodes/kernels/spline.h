#pragma once
// Piecewise polynomial and rational curves in one form: a B-spline over knots. A Bezier curve is the spline
// of one span whose ends have full multiplicity, and de Boor's algorithm is then de Casteljau's, step by
// step.
//
// Inside a span [u_i, u_i+1) of positive length every denominator of de Boor's algorithm holds that span:
// no 0 / 0 arises, whatever knots repeat. (Cox's recurrence for the basis does meet it, and needs 0 / 0 = 0
// by convention.)
//
// Source: de Boor 1972, J. Approx. Theory 6:50; Ramshaw 1989, "Blossoms are polar forms", CAGD 6:323.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <utility>
#include <vector>

#include "nodes/kernels/vector.h"

namespace frustum::kernels {

template <class V>
struct ScalarOf {
  using type = V;
};
template <glm::length_t n, class R, glm::qualifier q>
struct ScalarOf<glm::vec<n, R, q>> {
  using type = R;
};

// x within [a, b], or [b, a]. NaN stays NaN.
template <std::floating_point R>
R between_ends(R x, R a, R b) {
  return std::min(std::max(x, std::min(a, b)), std::max(a, b));
}
template <glm::length_t n, std::floating_point R>
glm::vec<n, R> between_ends(glm::vec<n, R> x, const glm::vec<n, R>& a, const glm::vec<n, R>& b) {
  for (glm::length_t k = 0; k < n; ++k) x[k] = between_ends(x[k], a[k], b[k]);
  return x;
}

// away a + along b, for away + along = 1 but for rounding. Where both are at least 0 the result lies
// between a and b, and is a, bit for bit, where b is a. Rounding: 1.5 ulp of the larger of both products.
// Exact for exact types.
template <class V, class S = typename ScalarOf<V>::type>
V mixed(const V& a, const V& b, const S& away, const S& along) {
  const V sum = a * away + b * along;
  if constexpr (std::floating_point<S>) {
    if (away >= 0 && along >= 0) return between_ends(sum, a, b);
  }
  return sum;
}

// The blossom of one span's polynomial at the parameters t(1) ... t(p): the value where all are the same.
// `d` holds the p + 1 control points of the span and is overwritten; `knots` are the 2 p around it, of
// which the middle two differ. Convex combinations only, while t stays in the span. Cost: p (p + 1) / 2
// mixes.
template <class V, class T, class At>
V blossom(std::span<V> d, std::span<const T> knots, const At& t) {
  using S = typename ScalarOf<V>::type;
  const std::size_t p = d.size() - 1;
  for (std::size_t r = 1; r <= p; ++r) {
    const T at = t(r);
    const T *low = nullptr, *high = nullptr;
    S away{}, along{};
    for (std::size_t j = p; j >= r; --j) {
      const T &lower = knots[j - 1], &upper = knots[p + j - r];
      if (low == nullptr || *low != lower || *high != upper) {
        low = &lower, high = &upper;
        const T width = upper - lower, rest = upper - at, gone = at - lower;
        const T away_wide = rest / width, along_wide = gone / width;
        away = static_cast<S>(away_wide), along = static_cast<S>(along_wide);
      }
      d[j] = mixed(d[j - 1], d[j], away, along);
    }
  }
  return d[p];
}

// The value at t; beyond the span its polynomial goes on.
template <class V, class T>
V de_boor(std::span<V> d, std::span<const T> knots, const T& t) {
  return blossom(d, knots, [&](std::size_t) { return t; });
}

// Makes control points and knots of a span those of its derivative, of degree p - 1. Requires p >= 1.
template <class V, class T>
void differentiate(std::span<V>& d, std::span<const T>& knots) {
  using S = typename ScalarOf<V>::type;
  const std::size_t p = d.size() - 1;
  for (std::size_t j = 0; j < p; ++j) {
    const T width = knots[p + j] - knots[j], factor = T(static_cast<int>(p)) / width;
    const V step = d[j + 1] - d[j];
    d[j] = step * static_cast<S>(factor);
  }
  d = d.first(p);
  knots = knots.subspan(1, 2 * p - 2);
}

// Which side of a knot is meant where both meet.
enum class KnotSide : std::uint8_t { before, after };

// A curve of degree p: n points, n + p + 1 knots that never fall, and n weights or none. It runs over
// [knots[p], knots[n]], which is not empty.
struct Spline {
  std::size_t degree = 0;
  std::span<const glm::dvec3> points;
  std::span<const double> weights;
  std::span<const double> knots;

  bool rational() const { return !weights.empty(); }
  double first() const { return knots[degree]; }
  double last() const { return knots[points.size()]; }

  // The i of the span [knots[i], knots[i + 1]] of positive length that holds t; outside of the domain the
  // one at its end. Cost: O(log n).
  std::size_t span_at(double t, KnotSide side = KnotSide::after) const {
    const auto begin = knots.begin() + static_cast<std::ptrdiff_t>(degree),
               end = knots.begin() + static_cast<std::ptrdiff_t>(points.size()) + 1;
    auto at = begin;
    if (t >= *(end - 1))
      at = std::lower_bound(begin, end, *(end - 1));
    else if (side == KnotSide::before && t > *begin)
      at = std::lower_bound(begin, end, t);
    else
      at = std::upper_bound(begin, end, t > *begin ? t : *begin);
    return static_cast<std::size_t>(at - knots.begin()) - 1;
  }
  std::span<const double> knots_of(std::size_t span) const {
    return degree == 0 ? knots.first(0) : knots.subspan(span + 1 - degree, 2 * degree);
  }
};

// The spans of positive length, in order.
inline std::vector<std::size_t> spans_of(const Spline& s) {
  std::vector<std::size_t> out;
  for (std::size_t i = s.degree; i < s.points.size(); ++i)
    if (s.knots[i] < s.knots[i + 1]) out.push_back(i);
  return out;
}

// Control points (w x, w y, w z, w) of a span, their weights scaled by a power of two to at most 2: exact
// but for the products. A polynomial's weights are 1.
inline std::vector<glm::dvec4> homogeneous(const Spline& s, std::size_t span) {
  std::vector<glm::dvec4> h;
  double largest = 0;
  for (std::size_t i = span - s.degree; i <= span; ++i)
    largest = std::max(largest, s.rational() ? std::fabs(s.weights[i]) : 1.0);
  const double scale = largest > 0 ? power_of_two_towards_one(largest) : 1;
  for (std::size_t i = span - s.degree; i <= span; ++i) {
    const double w = s.rational() ? s.weights[i] * scale : 1;
    h.emplace_back(s.points[i] * w, w);
  }
  return h;
}

// Bezier points, homogeneous, of the part [a, b] of a span. Cost: O(p^3), or none where the knots are
// already those of a Bezier curve over [a, b].
inline std::vector<glm::dvec4> bezier_points(const Spline& s, std::size_t span, double a, double b) {
  const std::vector<glm::dvec4> h = homogeneous(s, span);
  const auto knots = s.knots_of(span);
  if (s.degree == 0 ||
      (knots.front() == a && knots[s.degree - 1] == a && knots[s.degree] == b && knots.back() == b))
    return h;
  std::vector<glm::dvec4> out, scratch;
  for (std::size_t j = 0; j <= s.degree; ++j) {
    scratch = h;
    out.push_back(
        blossom(std::span(scratch), knots, [&](std::size_t r) { return r <= s.degree - j ? a : b; }));
  }
  return out;
}

// Evaluates a curve. Polynomials in R: value within 2 p u max|P| of the span (its points within their box,
// and the first or last point, bit for bit, at an end of full multiplicity). Rational curves in double and
// rounded once: within 4 p u max|P| where no weight is below 0. Derivatives lose what their differences
// cancel.
template <std::floating_point R>
class SplinePoints {
 public:
  explicit SplinePoints(const Spline& s) : s_(s) {}

  // Value and derivatives of order 0 ... out.size() - 1 at t, by the span on that side. NaN and infinities
  // of control points, and what overflows, come through.
  void at(double t, std::span<glm::dvec3> out, KnotSide side = KnotSide::after) {
    const std::size_t span = s_.span_at(t, side);
    if (s_.rational())
      rational(span, t, out);
    else
      polynomial(span, t, out);
  }
  glm::dvec3 at(double t) {
    glm::dvec3 out;
    at(t, {&out, 1});
    return out;
  }

 private:
  // Derivatives of the span's control points `local`, each handed to out(order, value).
  template <class V, class Out>
  void derivatives(const std::vector<V>& local, std::vector<V>& work, std::vector<V>& scratch,
                   std::size_t span, double t, std::size_t orders, const Out& out) {
    work = local;
    std::span<V> d(work);
    std::span<const double> knots = s_.knots_of(span);
    for (std::size_t k = 0; k < orders; ++k) {
      if (k > s_.degree) {
        out(k, V(0));
        continue;
      }
      scratch.assign(d.begin(), d.end());
      out(k, de_boor(std::span<V>(scratch), knots, t));
      if (k < s_.degree && k + 1 < orders) differentiate(d, knots);
    }
  }

  void polynomial(std::size_t span, double t, std::span<glm::dvec3> out) {
    local_.clear();
    for (std::size_t i = span - s_.degree; i <= span; ++i) local_.emplace_back(s_.points[i]);
    derivatives(local_, work_, scratch_, span, t, out.size(),
                [&](std::size_t k, const glm::vec<3, R>& v) { out[k] = glm::dvec3(v); });
  }

  void rational(std::size_t span, double t, std::span<glm::dvec3> out) {
    wide_local_ = homogeneous(s_, span);
    wide_.assign(out.size(), glm::dvec4(0));
    derivatives(wide_local_, wide_work_, wide_scratch_, span, t, out.size(),
                [&](std::size_t k, const glm::dvec4& v) { wide_[k] = v; });
    // (w C)^(k) = sum_i binomial(k, i) w^(i) C^(k - i), solved for C^(k).
    for (std::size_t k = 0; k < out.size(); ++k) {
      glm::dvec3 sum(wide_[k]);
      double choose = 1;
      for (std::size_t i = 1; i <= k; ++i) {
        choose = choose * static_cast<double>(k - i + 1) / static_cast<double>(i);
        sum -= out[k - i] * (choose * wide_[i].w);
      }
      out[k] = sum / wide_[0].w;
      if (k == 0) out[0] = settled(span, t, out[0]);
    }
    for (glm::dvec3& v : out) v = glm::dvec3(glm::vec<3, R>(v));
  }

  // What the limit or the convex hull says of a value that rounding, or 0 / 0, has moved. Near the start of
  // a span its basis functions vanish the faster the later they come: where all weights that count there
  // are 0, the curve tends to its first point with a weight; and so from the end.
  glm::dvec3 settled(std::size_t span, double t, const glm::dvec3& v) const {
    const auto knots = s_.knots_of(span);
    const std::size_t p = s_.degree, low = span - p;
    if (p == 0) return s_.points[span];
    const auto weight = [&](std::size_t i) { return s_.weights[i]; };
    const bool vanished = wide_[0].w == 0;
    if (t == knots[p - 1] && (vanished || knots.front() == t))
      for (std::size_t i = low; i <= span; ++i)
        if (weight(i) != 0) return s_.points[i];
    if (t == knots[p] && (vanished || knots.back() == t))
      for (std::size_t i = span + 1; i-- > low;)
        if (weight(i) != 0) return s_.points[i];
    if (t < knots[p - 1] || t > knots[p]) return v;
    glm::dvec3 lowest(INFINITY), highest(-INFINITY);
    for (std::size_t i = low; i <= span; ++i) {
      if (weight(i) < 0) return v;
      if (weight(i) == 0) continue;
      for (glm::length_t k = 0; k < 3; ++k) {
        lowest[k] = std::min(lowest[k], s_.points[i][k]);
        highest[k] = std::max(highest[k], s_.points[i][k]);
      }
    }
    return between_ends(v, lowest, highest);
  }

  Spline s_;
  std::vector<glm::vec<3, R>> local_, work_, scratch_;
  std::vector<glm::dvec4> wide_local_, wide_work_, wide_scratch_, wide_;
};

}  // namespace frustum::kernels
