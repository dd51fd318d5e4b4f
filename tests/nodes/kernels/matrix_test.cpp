#include "nodes/kernels/matrix.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/matrix.hpp>

#include "tests/support/ulps.h"

namespace frustum {
namespace {

using test::Random;
using test::ulps;

template <glm::length_t n>
kernels::Square<n> hilbert() {
  kernels::Square<n> m;
  for (glm::length_t c = 0; c < n; ++c)
    for (glm::length_t r = 0; r < n; ++r) m[c][r] = 1.0 / (1 + c + r);
  return m;
}

// Gauss-Jordan in __float128, for matrices that need no pivoting.
template <glm::length_t n>
kernels::Square<n> oracle(const kernels::Square<n>& m) {
  __extension__ using quad = __float128;
  quad a[n][2 * n];
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < 2 * n; ++c) a[r][c] = c < n ? static_cast<quad>(m[c][r]) : quad(c - n == r ? 1 : 0);
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int r = k; r < n; ++r)
      if ((a[r][k] < 0 ? -a[r][k] : a[r][k]) > (a[pivot][k] < 0 ? -a[pivot][k] : a[pivot][k])) pivot = r;
    for (int c = 0; c < 2 * n; ++c) std::swap(a[k][c], a[pivot][c]);
    const quad d = a[k][k];
    for (int c = 0; c < 2 * n; ++c) a[k][c] /= d;
    for (int r = 0; r < n; ++r) {
      if (r == k) continue;
      const quad f = a[r][k];
      for (int c = 0; c < 2 * n; ++c) a[r][c] -= f * a[k][c];
    }
  }
  kernels::Square<n> x;
  for (int r = 0; r < n; ++r)
    for (int c = 0; c < n; ++c) x[c][r] = static_cast<double>(a[r][n + c]);
  return x;
}

// XFM-03: exact reciprocals, and singular only where it is.
TEST(Inverse, OfADiagonalIsExact) {
  for (const glm::dvec4 s : {glm::dvec4(1e-20), glm::dvec4(1e-12), glm::dvec4(1e12, 1, 1e-12, 1),
                             glm::dvec4(-3, 1e150, 1e-150, 7)}) {
    glm::dmat4 m(0.0);
    for (glm::length_t i = 0; i < 4; ++i) m[i][i] = s[i];
    const auto x = kernels::inverse<4>(m);
    ASSERT_TRUE(x.has_value());
    for (glm::length_t i = 0; i < 4; ++i) EXPECT_LE(ulps(x->matrix[i][i], 1.0L / s[i]), 1);
    EXPECT_GT(x->rcond, 0.2);
  }
  EXPECT_FALSE(std::isfinite(glm::inverse(glm::mat4(1e-20F))[0][0]));  // the plain form
}

// XFM-15.
TEST(Inverse, PivotsAndRefines) {
  glm::dmat3 small(1.0);
  small[0] = {1e-20, 1, 0}, small[1] = {1, 1, 0};
  EXPECT_NEAR(kernels::inverse<3>(small)->matrix[0][0], -1, 4e-16);
  const auto h = kernels::inverse<4>(hilbert<4>());
  const auto exact = oracle<4>(hilbert<4>());
  for (glm::length_t c = 0; c < 4; ++c)
    for (glm::length_t r = 0; r < 4; ++r)
      EXPECT_NEAR(h->matrix[c][r], exact[c][r], 4 * 0x1p-53 * std::fabs(exact[2][2]));
  EXPECT_LT(h->rcond, 1e-3);  // the condition of the equilibrated matrix is about 1e4
  EXPECT_GT(h->rcond, 1e-5);
}

TEST(Inverse, StaysWithinItsBoundForRandomMatrices) {
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    glm::dmat4 m;
    for (glm::length_t c = 0; c < 4; ++c)
      for (glm::length_t r = 0; r < 4; ++r) m[c][r] = random.uniform(-1, 1);
    if (i % 3 == 0) m[3] = m[0] + m[1] * 2.0 + m[3] * 1e-9;
    const auto x = kernels::inverse<4>(m);
    ASSERT_TRUE(x.has_value());
    const auto exact = oracle<4>(m);
    double largest = 0;
    for (glm::length_t c = 0; c < 4; ++c) largest = std::max(largest, kernels::largest_component(exact[c]));
    const double bound = (8 * 0x1p-53 + 16 * 0x1p-106 / (x->rcond * x->rcond)) * largest;
    for (glm::length_t c = 0; c < 4; ++c)
      EXPECT_LE(kernels::largest_component(x->matrix[c] - exact[c]), bound) << x->rcond;
  }
}

TEST(Inverse, RefusesSingularAndNonFiniteMatrices) {
  EXPECT_FALSE(kernels::inverse<3>(glm::dmat3(0.0)).has_value());
  glm::dmat3 rank2({1, 2, 3}, {4, 5, 6}, {7, 8, 9});
  EXPECT_FALSE(kernels::inverse<3>(rank2).has_value());
  glm::dmat4 undefined(1.0);
  undefined[2][1] = std::nan("");
  EXPECT_FALSE(kernels::inverse<4>(undefined).has_value());
  // PRJ-10: the notes' perspective, whose last column is zero.
  glm::dmat4 notes(1.0);
  notes[2][3] = -1, notes[3][3] = 0;
  EXPECT_FALSE(kernels::inverse<4>(notes).has_value());
}

}  // namespace
}  // namespace frustum
