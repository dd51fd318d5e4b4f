// The basis functions of a B-spline.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace frustum::b_spline {

// The degree + 1 basis functions that are not 0 in the span of these knots (2 p of them, the middle two
// different), at t. Each is at least 0 while t stays in the span, and within 4 p u; they add up to 1 within
// 4 p u. No 0 / 0 arises. Cost: p (p + 1) / 2 steps. Source: de Boor 1972; Piegl & Tiller 1997, "The NURBS
// Book", A2.2.
template <class T>
std::vector<T> basis(std::span<const T> knots, const T& t) {
  const std::size_t p = knots.size() / 2;
  std::vector<T> n(p + 1, T(0));
  n[0] = T(1);
  for (std::size_t r = 1; r <= p; ++r) {
    T carried(0);
    for (std::size_t k = 0; k < r; ++k) {
      const T &upper = knots[p + k], &lower = knots[p + k - r];
      const T share = n[k] / T(upper - lower);
      n[k] = carried + T(upper - t) * share;
      carried = T(t - lower) * share;
    }
    n[r] = carried;
  }
  return n;
}

}  // namespace frustum::b_spline
