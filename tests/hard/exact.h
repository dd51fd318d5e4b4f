// The oracles' arithmetic, none of it the implementation's: rationals (GMP) where the exact answer is one,
// and reals of any precision (MPFR) that are computed again with twice the digits until two results agree.
#pragma once

#include <gmpxx.h>
#include <mpfr.h>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <functional>

namespace frustum::hard {

using Rational = mpq_class;

// A real number in the precision under way (see `exact`).
class Real {
 public:
  Real() { mpfr_init2(x_, precision), mpfr_set_zero(x_, 1); }
  Real(double value) : Real() { mpfr_set_d(x_, value, MPFR_RNDN); }
  Real(const Rational& value) : Real() { mpfr_set_q(x_, value.get_mpq_t(), MPFR_RNDN); }
  Real(const Real& other) : Real() { mpfr_set(x_, other.x_, MPFR_RNDN); }
  Real& operator=(const Real& other) {
    if (this != &other) mpfr_set_prec(x_, precision), mpfr_set(x_, other.x_, MPFR_RNDN);
    return *this;
  }
  ~Real() { mpfr_clear(x_); }

  mpfr_ptr get() { return x_; }
  mpfr_srcptr get() const { return x_; }
  double to_double() const { return mpfr_get_d(x_, MPFR_RNDN); }
  bool is_zero() const { return mpfr_zero_p(x_) != 0; }

  static inline thread_local mpfr_prec_t precision = 256;  // bits

 private:
  mpfr_t x_;
};

Real operator+(const Real&, const Real&);
Real operator-(const Real&, const Real&);
Real operator*(const Real&, const Real&);
Real operator/(const Real&, const Real&);
Real operator-(const Real&);
bool operator<(const Real&, const Real&);
Real abs(const Real&);
Real sqrt(const Real&);
Real cbrt(const Real&);
Real sin(const Real&);
Real cos(const Real&);
Real tan(const Real&);
Real exp(const Real&);
Real log(const Real&);
Real log2(const Real&);
Real log10(const Real&);
Real acos(const Real&);
Real atan2(const Real& y, const Real& x);
Real pow(const Real& base, const Real& exponent);
Real pi();

// `compute` in rising precision, until two results agree to 2^-120; both are then right to double many times
// over. Zero is believed when it is found twice.
Real exact(const std::function<Real()>& compute);
template <std::size_t n>
std::array<Real, n> exact_all(const std::function<std::array<Real, n>()>& compute) {
  std::array<Real, n> out;
  for (std::size_t i = 0; i < n; ++i) out[i] = exact([&] { return compute()[i]; });
  return out;
}

// |got - want| in units of the last place of R at `want`; of the least subnormal below the normal range.
// Infinite for NaN, and where only one of them is beyond R's range.
double ulps(float got, const Real& want);
double ulps(double got, const Real& want);
// |got - want| / scale; infinite for NaN.
double distance(double got, const Real& want, const Real& scale = 1.0);
double distance(double got, const Rational& want, const Rational& scale = 1);

inline constexpr double u32 = 0x1p-24, u64 = 0x1p-53;  // half an ulp of 1: what one rounding may cost
template <std::floating_point R>
inline constexpr double unit_roundoff = sizeof(R) == 4 ? u32 : u64;

}  // namespace frustum::hard
