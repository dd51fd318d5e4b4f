#pragma once
// Bezier curves over [0, 1] by five ways of evaluating them, and their changes of basis. The changes of
// basis and de Casteljau's algorithm are templates over any numbers, so that they can be checked in exact
// ones.
// Errata E61 (the matrix takes p0 p1 p2 p3, not tangents) and E62 (the basis is above 0 inside, and may be
// below outside).

#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/spline.h"

namespace frustum::kernels {

// Repeated mixing; `d` is overwritten. visit(level, i, point) sees every point of the triangle below its
// first row.
template <class V, class S, class Visit>
V casteljau(std::span<V> d, const S& t, const Visit& visit) {
  const S away = S(1) - t;
  for (std::size_t level = 1; level < d.size(); ++level)
    for (std::size_t i = 0; i + level < d.size(); ++i) {
      d[i] = mixed(d[i], d[i + 1], away, t);
      visit(level, i, d[i]);
    }
  return d[0];
}
template <class V, class S>
V casteljau(std::span<V> d, const S& t) {
  return casteljau(d, t, [](std::size_t, std::size_t, const V&) {});
}

// B_0 ... B_n at t. In [0, 1]: by their ratios, outwards from the largest of them, divided by their sum. No
// binomial is formed, so no degree overflows; what is below the range is 0. Within (n + 3) 2 u of each, and
// none below 0. Outside of [0, 1]: by the triangle of the recurrence, whose terms have signs. Cost: O(n)
// inside, O(n^2) outside.
// Source: Farouki 2012, "The Bernstein polynomial basis: a centennial retrospective", CAGD 29:379, for the
// basis.
template <std::floating_point R>
std::vector<R> bernstein(std::size_t n, R t) {
  std::vector<R> b(n + 1, R(0));
  const R away = 1 - t;
  if (!(t >= 0 && t <= 1)) {
    b[0] = 1;
    for (std::size_t level = 1; level <= n; ++level) {
      for (std::size_t i = level; i > 0; --i) b[i] = b[i] * away + b[i - 1] * t;
      b[0] *= away;
    }
    return b;
  }
  const std::size_t mode =
      std::min(n, static_cast<std::size_t>(static_cast<double>(n + 1) * static_cast<double>(t)));
  b[mode] = 1;
  for (std::size_t i = mode; i < n && b[i] > 0; ++i)
    b[i + 1] = b[i] * (static_cast<R>(n - i) * t) / (static_cast<R>(i + 1) * away);
  for (std::size_t i = mode; i > 0 && b[i] > 0; --i)
    b[i - 1] = b[i] * (static_cast<R>(i) * away) / (static_cast<R>(n - i + 1) * t);
  R sum = 0;
  for (const R x : b) sum += x;
  for (R& x : b) x /= sum;
  return b;
}

// binomial(n, 0) ... binomial(n, n): exact while they are below 2^53 (float: 2^24), then within n u.
template <class S>
std::vector<S> binomials(std::size_t n) {
  std::vector<S> c(n + 1, S(1));
  for (std::size_t i = 1; i <= n; ++i) {
    const S above = c[i - 1] * S(static_cast<int>(n - i + 1));
    c[i] = above / S(static_cast<int>(i));
  }
  return c;
}

// a_0 ... a_n of P(t) = sum a_i t^i: a_i = binomial(n, i) times the i-th forward difference of the points.
// Rounding grows with the differences that cancel: by up to 3^n of |P|.
template <class V, class S = typename ScalarOf<V>::type>
std::vector<V> power_of_bezier(std::span<const V> points) {
  std::vector<V> d(points.begin(), points.end()), a;
  const std::vector<S> choose = binomials<S>(points.size() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    a.push_back(d[0] * choose[i]);
    for (std::size_t j = 0; j + i + 1 < points.size(); ++j) d[j] = d[j + 1] - d[j];
  }
  return a;
}

// The way back: a_i / binomial(n, i) are the differences at the first point, and those of lower order are
// sums of them.
template <class V, class S = typename ScalarOf<V>::type>
std::vector<V> bezier_of_power(std::span<const V> coefficients) {
  const std::size_t n = coefficients.size() - 1;
  const std::vector<S> choose = binomials<S>(n);
  std::vector<V> d;
  for (std::size_t i = 0; i <= n; ++i) d.push_back(coefficients[i] / choose[i]);
  for (std::size_t level = n; level-- > 0;)
    for (std::size_t j = level + 1; j <= n; ++j) d[j] = d[j] + d[j - 1];
  return d;
}

// A t^0 + ... by Horner's rule.
template <class V, class S>
V horner(std::span<const V> a, const S& t) {
  V sum = a.back();
  for (std::size_t i = a.size() - 1; i-- > 0;) sum = sum * t + a[i];
  return sum;
}

// (1 - t)^n sum binomial(n, i) P_i (t / (1 - t))^i, or its mirror image above 1/2, so that the ratio is at
// most 1. Cost: O(n). Source: Schumaker & Volk 1986, "Efficient evaluation of multivariate polynomials",
// CAGD 3:149.
template <class V, class S>
V volk_schumaker(std::span<const V> p, const S& t) {
  const std::size_t n = p.size() - 1;
  const S away = 1 - t;
  const bool mirrored = t > away;
  const S ratio = mirrored ? away / t : t / away, base = mirrored ? t : away;
  const std::vector<S> choose = binomials<S>(n);
  const auto at = [&](std::size_t i) { return p[mirrored ? n - i : i] * choose[i]; };
  V sum = at(n);
  for (std::size_t i = n; i-- > 0;) sum = sum * ratio + at(i);
  S power = 1;
  for (std::size_t i = 0; i < n; ++i) power *= base;
  return sum * power;
}

// De Casteljau's algorithm in twice the digits, rounded once: u |P(t)| + 3 n^2 u^2 max|P|. Near a root of
// high multiplicity, where every digit of the plain algorithm is noise, this keeps the sign.
// Source: the aim of Jiang, Li, Cheng & Su 2010, CAMWA 60:744, by plain double-double arithmetic.
template <std::floating_point R>
R casteljau_compensated(std::span<const R> p, R t) {
  const TwoTerms<R> along{t, 0}, away = two_sum(R(1), -t);
  std::vector<TwoTerms<R>> d;
  for (const R x : p) d.push_back({x, 0});
  for (std::size_t level = 1; level < d.size(); ++level)
    for (std::size_t i = 0; i + level < d.size(); ++i)
      d[i] = plus(product(away, d[i]), product(along, d[i + 1]));
  return d[0].hi + d[0].lo;
}

// The inner two control points of a cubic over an interval of length h from its ends and its derivatives
// there, and the derivatives from the points (errata E68). Each inner point is within u (|P| + h |r|) of
// where it should be.
template <class V, class S>
V after_start(const V& p0, const V& r0, const S& h) {
  return p0 + r0 * h / S(3);
}
template <class V, class S>
V before_end(const V& p3, const V& r3, const S& h) {
  return p3 - r3 * h / S(3);
}

}  // namespace frustum::kernels
