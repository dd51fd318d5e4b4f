#pragma once
// Weighted sums of vectors and points, from plain sums to sums rounded once.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <utility>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/sum.h"

namespace frustum::kernels {

enum class Summation : std::uint8_t {
  plain,        // error up to n u sum|a x|
  compensated,  // products and sums to twice the precision: u |result| + n^2 u^2 sum|a x|
  exact         // rounded once, whatever cancels
};

constexpr auto choices(Summation) {
  return std::array{std::pair{Summation::plain, "plain"}, std::pair{Summation::compensated, "compensated"},
                    std::pair{Summation::exact, "exact"}};
}

// A sum of products a x. Exact and compensated while no product overflows or is below 2^-969; beyond that, and for
// factors above 2^990, products round as in a plain sum. NaN and infinities come through.
class SumOfProducts {
 public:
  explicit SumOfProducts(Summation how) : how_(how) {}

  void add(double a, double x) {
    if (how_ == Summation::plain) {
      plain_ += a * x;
      return;
    }
    const bool splits = std::fabs(a) < 0x1p990 && std::fabs(x) < 0x1p990 && std::isfinite(a * x);
    add(splits ? two_product(a, x) : TwoTerms<double>{a * x, 0});
  }
  double value() const {
    if (how_ == Summation::plain) return plain_;
    return how_ == Summation::exact ? exact_.value() : compensated_.value();
  }

 private:
  void add(TwoTerms<double> p) {
    if (how_ == Summation::exact) {
      exact_.add(p.hi), exact_.add(p.lo);
    } else {
      compensated_.add(p.hi), compensated_.add(p.lo);
    }
  }
  Summation how_;
  double plain_ = 0;
  CompensatedSum<double> compensated_;
  ExactSum exact_;
};

// sum a_i v_i. Requires as many weights as vectors.
inline glm::dvec3 linear_combination(std::span<const double> weights, std::span<const glm::dvec3> v,
                                     Summation how) {
  glm::dvec3 out;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    SumOfProducts sum(how);
    for (std::size_t i = 0; i < weights.size(); ++i) sum.add(weights[i], v[i][axis]);
    out[axis] = sum.value();
  }
  return out;
}

// sum a_i - 1, rounded once.
inline double drift_of(std::span<const double> weights) {
  ExactSum sum;
  sum.add(-1);
  for (const double a : weights) sum.add(a);
  return sum.value();
}

// The point that weights of sum 1 make of points: p_k + sum a_i (p_i - p_k), k the point of the largest weight,
// which so takes what the other weights leave to 1. It moves with the points wherever they are, and is p where
// all are p, also where rounding has made the weights' sum 1 + ulp. `plain` is sum a_i p_i, which drifts by
// (sum a_i - 1) |p|. Requires weights and points, as many of each.
// Source: Goldman 2002, "Pyramid Algorithms", chapter 1.
inline glm::dvec3 affine_combination(std::span<const double> weights, std::span<const glm::dvec3> p,
                                     Summation how) {
  if (how == Summation::plain) return linear_combination(weights, p, how);
  std::size_t k = 0;
  for (std::size_t i = 1; i < weights.size(); ++i)
    if (std::fabs(weights[i]) > std::fabs(weights[k])) k = i;
  glm::dvec3 out;
  for (glm::length_t axis = 0; axis < 3; ++axis) {
    SumOfProducts sum(how);
    sum.add(1, p[k][axis]);
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (i == k) continue;
      const auto away = two_sum(p[i][axis], -p[k][axis]);
      sum.add(weights[i], away.hi), sum.add(weights[i], away.lo);
    }
    out[axis] = sum.value();
  }
  return out;
}

// Whether the weights add up to 1 but for their own rounding: a decimal is off by u |a|, and by as much again
// where it was computed.
inline bool adds_up_to_one(std::span<const double> weights) {
  double size = 0;
  for (const double a : weights) size += std::fabs(a);
  return std::fabs(drift_of(weights)) <= 0x1p-52 * size;
}

}  // namespace frustum::kernels
