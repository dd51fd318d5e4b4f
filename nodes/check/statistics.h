// The rows of a table of statistics.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>

namespace frustum {

/// sqrt(mean((x - mean)^2)) over the finite values: two passes, so that a large mean leaves its digits alone.
/// 0 where there is none. Summed in the order of the values. Source: Chan, Golub & LeVeque 1983, the
/// corrected two-pass algorithm.
class Deviation {
 public:
  explicit Deviation(double mean) : mean_(mean) {}
  void add(double x) {
    if (!std::isfinite(x)) return;
    const double d = x - mean_;
    sum_ += d, squares_ += d * d, ++count_;
  }
  double value() const {
    if (count_ == 0) return 0;
    const double n = static_cast<double>(count_);
    const double variance =
        (squares_ - sum_ * sum_ / n) / n;  // the correction takes out what rounding left in the mean
    return variance > 0 ? std::sqrt(variance) : 0;
  }

 private:
  double mean_, sum_ = 0, squares_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace frustum
