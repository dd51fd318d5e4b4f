#pragma once
// Inverses of small matrices that hold for every scale, with the condition that says what they are worth.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <limits>
#include <optional>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/predicates.h"
#include "nodes/kernels/vector.h"

namespace frustum::kernels {

template <glm::length_t n>
using Square = glm::mat<n, n, double>;  // glm: a[column][row]

template <glm::length_t n>
struct Inverse {
  Square<n> matrix;
  double
      rcond;  // 1 / (|A| |A^-1|) in the 1-norm, of the equilibrated matrix: 1 is perfect, below 1e-14 noise
};

namespace matrix_detail {

template <glm::length_t n>
double one_norm(const Square<n>& a) {
  double largest = 0;
  for (glm::length_t c = 0; c < n; ++c) {
    double sum = 0;
    for (glm::length_t r = 0; r < n; ++r) sum += std::fabs(a[c][r]);
    largest = std::max(largest, sum);
  }
  return largest;
}

// Gauss-Jordan elimination with partial pivoting; nothing where a pivot is zero.
template <glm::length_t n>
std::optional<Square<n>> eliminate(Square<n> a) {
  Square<n> x(1.0);
  for (glm::length_t k = 0; k < n; ++k) {
    glm::length_t pivot = k;
    for (glm::length_t r = k + 1; r < n; ++r)
      if (std::fabs(a[k][r]) > std::fabs(a[k][pivot])) pivot = r;
    if (!(std::fabs(a[k][pivot]) > 0)) return std::nullopt;
    const double d = a[k][pivot];
    for (glm::length_t c = 0; c < n; ++c) {
      std::swap(a[c][k], a[c][pivot]);
      std::swap(x[c][k], x[c][pivot]);
      a[c][k] /= d;
      x[c][k] /= d;
    }
    for (glm::length_t r = 0; r < n; ++r) {
      if (r == k) continue;
      const double f = a[k][r];
      for (glm::length_t c = 0; c < n; ++c) {
        a[c][r] -= f * a[c][k];
        x[c][r] -= f * x[c][k];
      }
    }
  }
  return x;
}

// One Newton step X + X (I - A X), the residual in twice the precision: where A is not hopeless the error of
// X falls to a few u.
template <glm::length_t n>
Square<n> refined(const Square<n>& a, const Square<n>& x) {
  Square<n> residual;
  for (glm::length_t c = 0; c < n; ++c)
    for (glm::length_t r = 0; r < n; ++r) {
      TwoTerms<double> sum{r == c ? 1.0 : 0.0, 0.0};
      for (glm::length_t k = 0; k < n; ++k) {
        const auto p = two_product(-a[k][r], x[c][k]);
        const auto s = two_sum(sum.hi, p.hi);
        sum = fast_two_sum(s.hi, s.lo + (sum.lo + p.lo));
      }
      residual[c][r] = sum.hi;
    }
  return x + x * residual;
}

}  // namespace matrix_detail

// The orthonormal matrix beside one whose columns are so up to some e << 1: |M^T M - I| <= 3 u + e^2. One
// step of Newton's iteration for the polar factor, M (3 I - M^T M) / 2, the residual in twice the precision;
// what is orthonormal already keeps its bits. Source: Higham 1986, SIAM J. Sci. Stat. Comput. 7:1160.
inline Square<3> orthonormalized(const Square<3>& m) {
  Square<3> residual;
  for (glm::length_t c = 0; c < 3; ++c)
    for (glm::length_t r = 0; r < 3; ++r) {
      TwoTerms<double> sum{r == c ? -1.0 : 0.0, 0.0};
      for (glm::length_t k = 0; k < 3; ++k) sum = plus(sum, two_product(m[r][k], m[c][k]));
      residual[c][r] = sum.hi * 0.5;
    }
  return m - m * residual;
}

// The inverse of any n x n matrix (3 or 4) of finite numbers, or nothing where it is singular: for n = 3
// exactly when its determinant is 0, for n = 4 when elimination finds no pivot, and whenever the inverse
// leaves the range of double. A diagonal of 1e-20 or of (1e12, 1, 1e-12) is as good as any other: rows and
// columns are first brought to size 1 by exact powers of two. Error below 4 u + 16 u^2 / rcond, relative to
// the largest entry of the equilibrated inverse. Source: Higham 2002, "Accuracy and Stability of Numerical
// Algorithms", sections 9.8, 12.1 and 14.6.
template <glm::length_t n>
std::optional<Inverse<n>> inverse(const Square<n>& matrix) {
  Square<n> a = matrix;
  std::array<double, static_cast<std::size_t>(n)> row_scale{}, column_scale{};
  for (glm::length_t r = 0; r < n; ++r) {
    glm::vec<n, double> row;
    for (glm::length_t c = 0; c < n; ++c) row[c] = a[c][r];
    const double largest = largest_component(row);
    if (!(largest > 0) || !std::isfinite(largest)) return std::nullopt;
    row_scale[static_cast<std::size_t>(r)] = power_of_two_towards_one(largest);
    for (glm::length_t c = 0; c < n; ++c) a[c][r] *= row_scale[static_cast<std::size_t>(r)];
  }
  for (glm::length_t c = 0; c < n; ++c) {
    const double largest = largest_component(a[c]);
    if (!(largest > 0)) return std::nullopt;
    column_scale[static_cast<std::size_t>(c)] = power_of_two_towards_one(largest);
    a[c] *= column_scale[static_cast<std::size_t>(c)];
  }
  if constexpr (n == 3) {
    if (determinant_sign(a[0], a[1], a[2]) == 0) return std::nullopt;
  }
  auto x = matrix_detail::eliminate<n>(a);
  if (!x) return std::nullopt;
  const double rcond = 1 / (matrix_detail::one_norm(a) * matrix_detail::one_norm(*x));
  if (rcond > 0x1p-50) *x = matrix_detail::refined<n>(a, *x);
  // A = R^-1 a C^-1, so A^-1 = C x R.
  for (glm::length_t c = 0; c < n; ++c)
    for (glm::length_t r = 0; r < n; ++r) {
      (*x)[c][r] *= column_scale[static_cast<std::size_t>(r)] * row_scale[static_cast<std::size_t>(c)];
      if (!std::isfinite((*x)[c][r])) return std::nullopt;
    }
  return Inverse<n>{*x, rcond};
}

}  // namespace frustum::kernels
