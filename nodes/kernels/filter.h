#pragma once
// Reconstruction filters: separable, even, zero beyond their radius.

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "nodes/kernels/elementary.h"
#include "nodes/kernels/sum.h"

namespace frustum::kernels {

enum class FilterKind : std::uint8_t { box, bartlett, gaussian, mitchell };
constexpr auto choices(FilterKind) {
  return std::array{std::pair{FilterKind::box, "box"}, std::pair{FilterKind::bartlett, "bartlett"},
                    std::pair{FilterKind::gaussian, "gaussian"}, std::pair{FilterKind::mitchell, "mitchell"}};
}

//   box       1 on [-radius, radius), so that abutting boxes share no sample
//   bartlett  1 - |x| / radius (errata E50: Bartlett, with one t less)
//   gaussian  exp(-x^2 / 2 sigma^2) less its value at the radius; sigma 0 means radius / 3
//   mitchell  the cubic of Mitchell & Netravali 1988, SIGGRAPH 22:221, stretched from 2 to the radius;
//             b = c = 1/3 is theirs, (1, 0) the cubic B-spline, (0, 1/2) Catmull-Rom
struct Filter {
  FilterKind kind = FilterKind::mitchell;
  double radius = 2;  // > 0, pixels
  double sigma = 0;   // pixels
  double b = 1.0 / 3, c = 1.0 / 3;
};

// A filter of one dimension, ready to evaluate; its coefficients are worked out once.
template <std::floating_point R>
class FilterCurve {
 public:
  explicit FilterCurve(const Filter& f) : kind_(f.kind), radius_(static_cast<R>(f.radius)) {
    const double sigma = f.sigma > 0 ? f.sigma : f.radius / 3;
    scale_ = static_cast<R>(f.kind == FilterKind::gaussian ? -0.5 / (sigma * sigma) : 2 / f.radius);
    edge_ = exp(scale_ * radius_ * radius_);
    const double near_zero[] = {(6 - 2 * f.b) / 6, (-18 + 12 * f.b + 6 * f.c) / 6,
                                (12 - 9 * f.b - 6 * f.c) / 6};
    for (std::size_t i = 0; i < 3; ++i) near_[i] = static_cast<R>(near_zero[i]);
    outer_[0] = static_cast<R>(-f.c), outer_[1] = static_cast<R>((f.b + 6 * f.c) / 6);
  }

  R radius() const { return radius_; }

  // The value at x pixels from the centre, not normalised: divide by the sum of the weights that are used.
  // 0 for NaN.
  R operator()(R x) const {
    if (!(x >= -radius_ && x < radius_)) return 0;
    const R a = std::fabs(x);
    switch (kind_) {
      case FilterKind::box: return 1;
      case FilterKind::bartlett: return (radius_ - a) / radius_;
      case FilterKind::gaussian: return exp(scale_ * a * a) - edge_;
      case FilterKind::mitchell: break;
    }
    const R t = a * scale_;
    if (t < 1) return near_[0] + t * t * (near_[1] + t * near_[2]);
    const R s = 2 - t;  // the outer cubic has a double root at 2: no cancellation in this form
    return s * s * (outer_[0] + s * outer_[1]);
  }

 private:
  FilterKind kind_;
  R radius_, scale_, edge_;
  R near_[3], outer_[2];
};

// Divides the weights by their sum, and gives what rounding leaves of 1 to the largest: added up in order they
// make 1 to within u. All zero stays so. Weights may be negative; a sum of 0 leaves them as they are.
template <std::floating_point R>
void normalize_weights(std::span<R> weights) {
  CompensatedSum<R> sum;
  for (const R w : weights) sum.add(w);
  const R total = sum.value();
  if (total == 0) return;
  CompensatedSum<R> left;
  left.add(1);
  std::size_t largest = 0;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    weights[i] /= total;
    left.add(-weights[i]);
    if (std::fabs(weights[i]) > std::fabs(weights[largest])) largest = i;
  }
  weights[largest] += left.value();
}

// Taps that a filter of this radius can touch, whatever its phase.
inline std::size_t filter_tap_count(double radius) {
  return 2 * static_cast<std::size_t>(std::ceil(radius)) + 1;
}

// Normalised weights of the points first, first + 1, ... (pixels from the filter's centre), one for each
// element of `weights`.
template <std::floating_point R>
void fill_filter_weights(const FilterCurve<R>& curve, R first, std::span<R> weights) {
  for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = curve(first + static_cast<R>(i));
  normalize_weights(weights);
}

}  // namespace frustum::kernels
