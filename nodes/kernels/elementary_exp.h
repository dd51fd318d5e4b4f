#pragma once
// exp, exp2, log, log2, pow: see elementary.h, which is the header to include.

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/elementary_constants.h"

namespace frustum::kernels {
namespace elementary {

inline constexpr double infinity = std::numeric_limits<double>::infinity();
inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// c[0] + x (c[1] + x (c[2] + ...)).
template <std::size_t N>
constexpr double horner(const std::array<double, N>& c, double x) {
  double sum = c[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

// 2^n for an integer -1022 <= n <= 1023.
inline double power_of_two(double n) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(n + round_to_exponent) << 52);
}

// Nearest integer, ties to even. Requires |x| < 2^51.
constexpr double nearest_integer(double x) { return (x + round_to_integer) - round_to_integer; }

// A positive, finite x as 2^k m, with m in [sqrt 1/2, sqrt 2).
struct Binade {
  double m, k;
};
inline Binade split_binade(double x) {
  const bool subnormal = x < std::numeric_limits<double>::min();
  const auto bits = std::bit_cast<std::int64_t>(subnormal ? x * 0x1p54 : x);
  const std::int64_t k = (bits - std::bit_cast<std::int64_t>(sqrt_half)) >> 52;
  return {std::bit_cast<double>(bits - (k << 52)), static_cast<double>(subnormal ? k - 54 : k)};
}

// 2^(x.hi + x.lo), error below 0.8 ulp (1 ulp when subnormal). Requires |x.hi| <= 2^12, |x.lo| <= ulp(x.hi).
inline double exp2_of(TwoTerms<double> x) {
  const double n = nearest_integer(x.hi);
  const auto r = two_sum(x.hi - n, x.lo);
  const double small = r.hi * ln2_lo + r.lo * ln2_hi;
  const auto line = fast_two_sum(1.0, r.hi * ln2_hi);
  const double power = line.hi + (line.lo + (small + (r.hi * r.hi) * horner(exp2_tail, r.hi)));
  // Two steps, since 2^n itself is out of range for subnormal results and for n = 1024.
  const double clamped = n < -1100 ? -1100 : (n > 1100 ? 1100 : n);
  const double half = nearest_integer(clamped * 0.5);
  return (power * power_of_two(half)) * power_of_two(clamped - half);
}

// log2 of a positive, finite x, relative error below 2^-65.
inline TwoTerms<double> log2_of(double x) {
  const auto [m, k] = split_binade(x);
  const auto s = quotient<double>({m - 1, 0.0}, m >= 1 ? fast_two_sum(m, 1.0) : fast_two_sum(1.0, m));
  const auto z = product(s, s);
  const auto inner = fast_two_sum(log2_c1_hi, z.hi * horner(log2_tail, z.hi));
  auto sum = product(z, {inner.hi, inner.lo + log2_c1_lo});
  const auto outer = fast_two_sum(log2_c0_hi, sum.hi);
  sum = product(s, {outer.hi, outer.lo + (sum.lo + log2_c0_lo)});
  const auto all = two_sum(k, sum.hi);
  return fast_two_sum(all.hi, all.lo + sum.lo);
}

// 2^x for float results, relative error below 2^-33. Any x but NaN; over- and underflow give inf and 0.
inline double exp2_short_of(double x) {
  const double clamped = x < -200 ? -200 : (x > 200 ? 200 : x);
  const double n = nearest_integer(clamped);
  const double r = clamped - n;
  return (1 + r * horner(exp2_short, r)) * power_of_two(n);
}

// log2 of a positive, finite, normal x for float results, relative error below 2^-43.
inline double log2_short_of(double x) {
  const auto bits = std::bit_cast<std::int64_t>(x);
  const std::int64_t k = (bits - std::bit_cast<std::int64_t>(sqrt_half)) >> 52;
  const double m = std::bit_cast<double>(bits - (k << 52));
  const double s = (m - 1) / (m + 1);
  const double z = s * s;
  return static_cast<double>(k) + s * (log2_c0_hi + z * horner(log2_short, z));
}

// log2 of any x for float results: -inf at 0, NaN below.
inline double log2_short_any(double x) {
  if (x == infinity) return infinity;
  return x > 0 ? log2_short_of(x) : (x == 0 ? -infinity : nan);
}

// What the sign of the base makes of |x|^y: 1, -1, or NaN for a negative base and a fractional exponent.
constexpr double power_sign(bool negative_base, double y) {
  if (!negative_base) return 1;
  if (!(y < 0x1p53 && y > -0x1p53)) return 1;  // an even integer, or infinite
  const auto n = static_cast<std::int64_t>(y);
  if (static_cast<double>(n) != y) return nan;
  return n % 2 != 0 ? -1 : 1;
}

inline double pow_double(double x, double y) {
  if (y == 0 || x == 1) return 1;
  if (x != x || y != y) return nan;
  const double base = x < 0 ? -x : x;
  double sign = power_sign(std::signbit(x), y);
  if (base == 1) return y == infinity || y == -infinity ? 1 : sign;
  if (base == 0 || base == infinity) {
    if (sign != sign) sign = 1;  // annex F: a zero or infinite base takes any exponent
    return sign * ((base == 0) == (y < 0) ? infinity : 0.0);
  }
  // |log2 x| >= 2^-53, so beyond 2^64 the power has left the range, and below 2^-80 it is 1.
  const double limited = y > 0x1p70 ? 0x1p70 : (y < -0x1p70 ? -0x1p70 : y);
  if (limited < 0x1p-80 && limited > -0x1p-80) return sign;
  const auto log = log2_of(base);
  const auto p = two_product(limited, log.hi);
  if (p.hi >= 1100) return sign * infinity;
  if (p.hi <= -1100) return sign * 0.0;
  return sign * exp2_of({p.hi, p.lo + limited * log.lo});
}

inline float pow_float(float x, float y) {
  if (y == 0 || x == 1) return 1;
  if (x != x || y != y) return std::numeric_limits<float>::quiet_NaN();
  const double base = x < 0 ? -x : x;
  double sign = power_sign(std::signbit(x), static_cast<double>(y));
  if (base == 1) return y - y == 0 ? static_cast<float>(sign) : 1.0F;
  if (sign != sign && (base == 0 || base == infinity)) sign = 1;
  return static_cast<float>(sign * exp2_short_of(static_cast<double>(y) * log2_short_any(base)));
}

}  // namespace elementary

// 2^x. Overflow gives infinity, underflow 0; integers are exact.
template <std::floating_point R>
R exp2(R x) {
  using namespace elementary;
  const double d = x;
  if (d != d) return std::numeric_limits<R>::quiet_NaN();
  if constexpr (sizeof(R) == 4) return static_cast<float>(exp2_short_of(d));
  return static_cast<R>(d > 1100 ? infinity : (d < -1100 ? 0.0 : exp2_of({d, 0.0})));
}

// e^x. exp(0) = 1 exactly.
template <std::floating_point R>
R exp(R x) {
  using namespace elementary;
  const double d = x;
  if (d != d) return std::numeric_limits<R>::quiet_NaN();
  if constexpr (sizeof(R) == 4) return static_cast<float>(exp2_short_of(d * log2_e_hi));
  if (d > 750 || d < -750) return static_cast<R>(d > 0 ? infinity : 0.0);
  const auto p = two_product(d, log2_e_hi);
  return static_cast<R>(exp2_of({p.hi, p.lo + d * log2_e_lo}));
}

// Logarithm to base 2. log2(2^n) = n exactly; -inf at 0, NaN below.
template <std::floating_point R>
R log2(R x) {
  using namespace elementary;
  const double d = x;
  if constexpr (sizeof(R) == 4) return static_cast<float>(log2_short_any(d));
  if (d > 0 && d < infinity) return static_cast<R>(log2_of(d).hi);
  return static_cast<R>(d == 0 ? -infinity : (d > 0 ? infinity : nan));
}

// Natural logarithm. log(1) = 0 exactly; -inf at 0, NaN below.
template <std::floating_point R>
R log(R x) {
  using namespace elementary;
  const double d = x;
  if constexpr (sizeof(R) == 4) return static_cast<float>(log2_short_any(d) * ln2_hi);
  if (d > 0 && d < infinity) return static_cast<R>(product(log2_of(d), {ln2_hi, ln2_lo}).hi);
  return static_cast<R>(d == 0 ? -infinity : (d > 0 ? infinity : nan));
}

// x^y with the special cases of annex F: pow(x, 0) = pow(1, y) = 1 even for NaN; a negative base takes
// integer exponents only.
template <std::floating_point R>
R pow(R x, R y) {
  if constexpr (sizeof(R) == 4)
    return elementary::pow_float(x, y);
  else
    return elementary::pow_double(x, y);
}

}  // namespace frustum::kernels
