#pragma once
// Sums that neither stagnate nor depend on threads.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "nodes/kernels/double_double.h"

namespace frustum::kernels {

// A running sum in twice the precision of R: the result is off by u |sum| + 2 n u^2 sum|x| at most. NaN and
// infinities come through as in a plain sum.
// Source: Kahan 1965; in double-double form, Ogita, Rump & Oishi 2005, SIAM J. Sci. Comput. 26:1955.
template <std::floating_point R>
class CompensatedSum {
 public:
  void add(R x) {
    const auto [sum, error] = two_sum(sum_.hi, x);
    sum_ = std::isfinite(sum) ? fast_two_sum(sum, error + sum_.lo) : TwoTerms<R>{sum, 0};
  }
  R value() const { return sum_.hi; }

 private:
  TwoTerms<R> sum_{0, 0};
};

// The sum of all terms rounded once, whatever their order: partial sums that do not overlap keep every bit.
// A few dozen terms at most for doubles of any size. NaN or infinities: what a plain sum gives.
// Source: Shewchuk 1997, DCG 18:305, section 2.3; as Python's math.fsum.
class ExactSum {
 public:
  void add(double x) {
    if (!std::isfinite(x)) {
      special_ += x;
      return;
    }
    std::size_t kept = 0;
    for (const double part : parts_) {
      const auto [sum, error] = two_sum(part, x);
      if (error != 0) parts_[kept++] = error;
      x = sum;
    }
    parts_.resize(kept);
    if (x != 0) parts_.push_back(x);
  }
  double value() const {
    if (special_ != 0) return special_;  // also NaN
    std::size_t n = parts_.size();
    if (n == 0) return 0;
    double hi = parts_[--n], lo = 0;
    while (n > 0 && lo == 0) {
      const auto [sum, error] = two_sum(hi, parts_[--n]);
      hi = sum, lo = error;
    }
    // A tie was broken to even, but the terms below say which side the sum is on.
    if (n > 0 && (lo < 0) == (parts_[n - 1] < 0)) {
      const double twice = 2 * lo, nudged = hi + twice;
      if (nudged - hi == twice) hi = nudged;
    }
    return hi;
  }

 private:
  std::vector<double> parts_;
  double special_ = 0;
};

// Combines n leaves in a binary tree whose shape depends on n alone: leaf(i) for 0 <= i < n, then
// combine(left, right), so that any number of threads may compute the leaves and the result is the same.
// Requires n > 0. Error of a sum: log2(n) u sum|x| instead of n u.
template <class Leaf, class Combine>
auto tree_reduce(std::size_t begin, std::size_t end, const Leaf& leaf, const Combine& combine)
    -> decltype(leaf(begin)) {
  if (end - begin == 1) return leaf(begin);
  std::size_t half = 1;
  while (2 * half < end - begin) half *= 2;
  return combine(tree_reduce(begin, begin + half, leaf, combine),
                 tree_reduce(begin + half, end, leaf, combine));
}

// Sum by a tree over runs of 64 terms; 0 for none.
template <std::floating_point R>
R pairwise_sum(std::span<const R> terms) {
  constexpr std::size_t run = 64;
  if (terms.empty()) return 0;
  const auto leaf = [&](std::size_t i) {
    R sum = 0;
    for (const R x : terms.subspan(i * run, std::min(run, terms.size() - i * run))) sum += x;
    return sum;
  };
  return tree_reduce(std::size_t{0}, (terms.size() + run - 1) / run, leaf, [](R a, R b) { return a + b; });
}

// Count, mean and sum of squared deviations; merging keeps both exact to a few u, where E[x^2] - E[x]^2
// loses all digits once the mean is far larger than the spread.
// Source: Welford 1962, Technometrics 4:419; Chan, Golub & LeVeque 1983, The American Statistician 37:242.
struct Moments {
  std::uint64_t count = 0;
  double mean = 0;
  double deviations = 0;  // sum of (x - mean)^2, never negative

  void add(double x) {
    ++count;
    const double delta = x - mean;
    mean += delta / static_cast<double>(count);
    deviations += delta * (x - mean);
  }
  Moments merged(const Moments& other) const {
    if (count == 0 || other.count == 0) return count == 0 ? other : *this;
    const auto n = static_cast<double>(count), m = static_cast<double>(other.count);
    const double delta = other.mean - mean;
    return {count + other.count, mean + delta * (m / (n + m)),
            deviations + other.deviations + delta * delta * (n * m / (n + m))};
  }
  // Of the population; 0 for fewer than one value.
  double variance() const { return count > 0 ? deviations / static_cast<double>(count) : 0; }
};

}  // namespace frustum::kernels
