// Distances in units in the last place, and the random inputs of the kernel tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

namespace frustum::test {

// |got - want| in ulps of R at `want` (of the smallest subnormal below the normal range). Infinite when one of
// them is NaN or only one of them overflows.
template <class R>
double ulps(R got, long double want) {
  const R rounded = static_cast<R>(want);
  if (std::isnan(got) || std::isnan(want)) return std::numeric_limits<double>::infinity();
  if (std::isinf(rounded) || std::isinf(got))
    return got == rounded ? 0 : std::numeric_limits<double>::infinity();
  if (want == 0) return got == 0 ? 0 : std::numeric_limits<double>::infinity();
  int exponent = 0;
  std::frexp(want, &exponent);
  using limits = std::numeric_limits<R>;
  const int last = std::max(exponent - limits::digits, limits::min_exponent - limits::digits);
  return static_cast<double>(std::ldexp(std::fabs(static_cast<long double>(got) - want), -last));
}

// Equal bits for every library: std's distributions may differ, the engine may not.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  std::uint64_t bits() { return engine_(); }
  double uniform(double lowest = 0, double highest = 1) {
    return lowest + (highest - lowest) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  // Either sign, magnitude between 2^lowest and 2^highest, evenly on a logarithmic scale.
  double magnitude(double lowest, double highest) {
    const double m = std::exp2(uniform(lowest, highest));
    return (engine_() & 1) != 0 ? m : -m;
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace frustum::test
