#pragma once
// sin, cos, tan and their inverses: see elementary.h, which is the header to include.

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <limits>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/elementary_constants.h"
#include "nodes/kernels/elementary_exp.h"
#include "nodes/kernels/elementary_reduce.h"

namespace frustum::kernels {

template <std::floating_point R>
struct SinCos {
  R sin, cos;
};

namespace elementary {

// Cody & Waite's reduction: q * half_pi[i] is exact, and so is the first difference.
inline Reduced reduce(double x) {
  if (x < 0.785 && x > -0.785) return {{x, 0.0}, 0};  // keeps the sign of zero
  if (!(x < 0x1p20 && x > -0x1p20)) return reduce_large(x);
  const double q = nearest_integer(x * two_over_pi);
  auto r = two_sum(x - q * half_pi[0], -(q * half_pi[1]));
  const auto third = two_sum(r.hi, -(q * half_pi[2]));
  const double low = r.lo + third.lo;
  const auto fourth = two_sum(third.hi, low);
  r = fast_two_sum(fourth.hi, fourth.lo - q * half_pi[3]);
  return {r, static_cast<unsigned>(static_cast<std::int64_t>(q)) & 3U};
}

// The same for an angle in degrees. The remainder is exact, so multiples of 90 degrees give 0, 1 and -1.
inline Reduced reduce_degrees(double degrees) {
  const double turn = std::fmod(degrees, 360.0);  // exact by IEEE 754; no libm approximation in it
  const double q = nearest_integer(turn / 90);
  const double r = turn - q * 90;
  if (q == 0 && r < 0x1p-900 && r > -0x1p-900) return {{r * radians_hi, 0.0}, 0};
  const auto p = two_product(r, radians_hi);
  return {fast_two_sum(p.hi, p.lo + r * radians_lo),
          static_cast<unsigned>(static_cast<std::int64_t>(q)) & 3U};
}

// sin and cos of |r| <= pi/4 as unevaluated sums; relative error of each sum below 2^-55.
struct SinCosTerms {
  TwoTerms<double> sin, cos;
};
inline SinCosTerms sin_cos_of(TwoTerms<double> r) {
  if (r.hi == 0) return {r, {1.0, 0.0}};  // keeps the sign of zero
  const double x = r.hi, z = x * x;
  const double half = 0.5 * z, one_less = 1 - half;
  const double sin_lo = r.lo * (1 - half) + x * z * horner(sin_tail, z);
  const double cos_lo = ((1 - one_less) - half) + (z * z * horner(cos_tail, z) - x * r.lo);
  return {fast_two_sum(x, sin_lo), fast_two_sum(one_less, cos_lo)};
}

// Turns sin and cos of the remainder into those of the angle.
inline SinCosTerms turned(const Reduced& angle) {
  const auto negative = [](TwoTerms<double> t) { return TwoTerms<double>{0 - t.hi, 0 - t.lo}; };
  const auto t = sin_cos_of(angle.r);
  switch (angle.quadrant) {
    case 1: return {t.cos, negative(t.sin)};
    case 2: return {negative(t.sin), negative(t.cos)};
    case 3: return {negative(t.cos), t.sin};
    default: return t;
  }
}

template <std::floating_point R>
SinCos<R> rounded(const SinCosTerms& t) {
  return {static_cast<R>(t.sin.hi), static_cast<R>(t.cos.hi)};
}

template <std::floating_point R>
R tangent(const SinCosTerms& t) {
  if (t.sin.hi == 0) return static_cast<R>(t.sin.hi);
  if (t.cos.hi == 0) return static_cast<R>(t.sin.hi > 0 ? infinity : -infinity);
  return static_cast<R>(quotient(t.sin, t.cos).hi);
}

// 0, pi/4, ..., pi.
inline constexpr std::array<TwoTerms<double>, 5> eighth_turns = {{
    {0.0, 0.0},
    {quarter_pi_hi, quarter_pi_lo},
    {2 * quarter_pi_hi, 2 * quarter_pi_lo},
    {0x1.2d97c7f3321d2p+1, 0x1.a79394c9e8a0ap-54},
    {4 * quarter_pi_hi, 4 * quarter_pi_lo},
}};

// atan2 of y.hi + y.lo and x.hi + x.lo, both finite; error below 0.6 ulp. The angle is found in the first
// half quadrant, where u = tan of the angle or of its difference from pi/4, and unfolded from there.
inline double atan2_of(TwoTerms<double> y, TwoTerms<double> x) {
  const bool y_negative = std::signbit(y.hi), x_negative = std::signbit(x.hi);
  if (y_negative) y = {-y.hi, -y.lo};
  if (x_negative) x = {-x.hi, -x.lo};
  const bool steep = y.hi > x.hi;
  const auto n = steep ? x : y, d = steep ? y : x;

  TwoTerms<double> u{0.0, 0.0};
  int eighths = 0;  // the nearest multiple of pi/4
  if (n.hi > d.hi * 0.4142) {
    const auto difference = two_sum(n.hi, -d.hi), sum = two_sum(d.hi, n.hi);
    u = quotient<double>({difference.hi, difference.lo + (n.lo - d.lo)}, {sum.hi, sum.lo + (n.lo + d.lo)});
    eighths = 1;
  } else if (n.hi > d.hi * 0x1p-900) {
    u = quotient(n, d);
  } else if (n.hi > 0) {
    u = {n.hi / d.hi, 0.0};  // the remainder would underflow, and does not matter
  }
  const double z = u.hi * u.hi;
  double tail = u.lo - u.lo * z + u.hi * z * horner(atan_tail, z);

  const bool flip = steep != x_negative;  // the unfolding runs against u
  if (steep) eighths = 2 - eighths;
  if (x_negative) eighths = 4 - eighths;
  if (flip) u.hi = -u.hi, tail = -tail;
  const auto [base_hi, base_lo] = eighth_turns[static_cast<std::size_t>(eighths)];
  const auto angle = two_sum(base_hi, u.hi);
  const double sum = angle.hi + (angle.lo + (base_lo + tail));
  return y_negative ? -sum : sum;
}

// x scaled by a power of two that brings `largest` into [1, 2). Requires 0 < largest < infinity.
inline double scaled_by(double x, double largest) {
  const double lifted = largest < 0x1p-1000 ? 0x1p100 : 1.0;
  const auto exponent = std::bit_cast<std::uint64_t>(largest * lifted) >> 52 & 0x7ff;
  const double down = std::bit_cast<double>((2046 - exponent) << 52);  // 2^(1023 - exponent)
  return exponent == 2046 ? x * 0.5 * 0x1p-1022 : x * lifted * down;
}

inline double atan2_any(double y, double x) {
  if (x != x || y != y) return nan;
  const double ay = std::fabs(y), ax = std::fabs(x);
  const double largest = ay > ax ? ay : ax;
  if (largest == infinity) {
    y = std::copysign(ay == infinity ? 1.0 : 0.0, y);
    x = std::copysign(ax == infinity ? 1.0 : 0.0, x);
  } else if (largest > 0) {
    y = scaled_by(y, largest);
    x = scaled_by(x, largest);
  }
  return atan2_of({y, 0.0}, {x, 0.0});
}

// sqrt(1 - x^2) for |x| <= 1, relative error below 2^-100 unless it is 0.
inline TwoTerms<double> other_leg(double x) {
  const auto a = two_sum(1.0, -x), b = two_sum(1.0, x);
  const auto square = product(a, b);
  if (square.hi <= 0) return {0.0, 0.0};
  const double root = std::sqrt(square.hi);
  const auto back = two_product(root, root);
  return fast_two_sum(root, (((square.hi - back.hi) - back.lo) + square.lo) / (2 * root));
}

}  // namespace elementary

// Sine and cosine of an angle in radians. NaN for infinities.
template <std::floating_point R>
SinCos<R> sin_cos(R x) {
  const double d = x;
  if (!(d - d == 0)) return {std::numeric_limits<R>::quiet_NaN(), std::numeric_limits<R>::quiet_NaN()};
  return elementary::rounded<R>(elementary::turned(elementary::reduce(d)));
}

template <std::floating_point R>
R sin(R x) {
  return sin_cos(x).sin;
}

template <std::floating_point R>
R cos(R x) {
  return sin_cos(x).cos;
}

template <std::floating_point R>
R tan(R x) {
  const double d = x;
  if (!(d - d == 0)) return std::numeric_limits<R>::quiet_NaN();
  return elementary::tangent<R>(elementary::turned(elementary::reduce(d)));
}

// Sine and cosine of an angle in degrees; multiples of 90 give exactly 0, 1 and -1. NaN for infinities.
template <std::floating_point R>
SinCos<R> sin_cos_degrees(R degrees) {
  const double d = degrees;
  if (!(d - d == 0)) return {std::numeric_limits<R>::quiet_NaN(), std::numeric_limits<R>::quiet_NaN()};
  return elementary::rounded<R>(elementary::turned(elementary::reduce_degrees(d)));
}

// Tangent of an angle in degrees: 0 at even and infinite at odd multiples of 90.
template <std::floating_point R>
R tan_degrees(R degrees) {
  const double d = degrees;
  if (!(d - d == 0)) return std::numeric_limits<R>::quiet_NaN();
  return elementary::tangent<R>(elementary::turned(elementary::reduce_degrees(d)));
}

// Angle of the point (x, y) in (-pi, pi], with annex F's signs at zeros and infinities.
template <std::floating_point R>
R atan2(R y, R x) {
  return static_cast<R>(elementary::atan2_any(y, x));
}

template <std::floating_point R>
R atan(R x) {
  return static_cast<R>(elementary::atan2_any(x, 1.0));
}

// Angle in [0, pi] whose cosine is x; NaN outside [-1, 1].
template <std::floating_point R>
R acos(R x) {
  const double d = x;
  if (!(d >= -1 && d <= 1)) return std::numeric_limits<R>::quiet_NaN();
  return static_cast<R>(elementary::atan2_of(elementary::other_leg(d), {d, 0.0}));
}

// Angle in [-pi/2, pi/2] whose sine is x; NaN outside [-1, 1].
template <std::floating_point R>
R asin(R x) {
  const double d = x;
  if (!(d >= -1 && d <= 1)) return std::numeric_limits<R>::quiet_NaN();
  return static_cast<R>(elementary::atan2_of({d, 0.0}, elementary::other_leg(d)));
}

}  // namespace frustum::kernels
