#include "tests/hard/exact.h"

#include <limits>
#include <stdexcept>

namespace frustum::hard {
namespace {

using Unary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);
using Binary = int (*)(mpfr_ptr, mpfr_srcptr, mpfr_srcptr, mpfr_rnd_t);

Real of(Unary f, const Real& x) {
  Real y;
  f(y.get(), x.get(), MPFR_RNDN);
  return y;
}
Real of(Binary f, const Real& a, const Real& b) {
  Real y;
  f(y.get(), a.get(), b.get(), MPFR_RNDN);
  return y;
}

bool agree(const Real& a, const Real& b) {
  if (a.is_zero() || b.is_zero()) return a.is_zero() && b.is_zero();
  return abs(a - b) < abs(a) * Real(0x1p-120);
}

template <class R>
double ulps_of(R got, const Real& want) {
  using limits = std::numeric_limits<R>;
  constexpr double infinity = limits::infinity();
  const bool beyond = !(abs(want) < Real(static_cast<double>(limits::max())) * Real(1 + 0x1p-25));
  if (std::isnan(got) || mpfr_nan_p(want.get()) != 0) return infinity;
  if (std::isinf(got) || beyond) return std::isinf(got) && beyond ? 0 : infinity;
  if (want.is_zero()) return got == 0 ? 0 : static_cast<double>(std::fabs(got) / limits::denorm_min());
  const long exponent = std::max<long>(mpfr_get_exp(want.get()), limits::min_exponent);
  Real off = abs(Real(static_cast<double>(got)) - want);
  mpfr_mul_2si(off.get(), off.get(), limits::digits - exponent, MPFR_RNDN);
  return off.to_double();
}

}  // namespace

Real operator+(const Real& a, const Real& b) { return of(mpfr_add, a, b); }
Real operator-(const Real& a, const Real& b) { return of(mpfr_sub, a, b); }
Real operator*(const Real& a, const Real& b) { return of(mpfr_mul, a, b); }
Real operator/(const Real& a, const Real& b) { return of(mpfr_div, a, b); }
Real operator-(const Real& x) { return of(mpfr_neg, x); }
bool operator<(const Real& a, const Real& b) { return mpfr_less_p(a.get(), b.get()) != 0; }
Real abs(const Real& x) { return of(mpfr_abs, x); }
Real sqrt(const Real& x) { return of(mpfr_sqrt, x); }
Real cbrt(const Real& x) { return of(mpfr_cbrt, x); }
Real sin(const Real& x) { return of(mpfr_sin, x); }
Real cos(const Real& x) { return of(mpfr_cos, x); }
Real tan(const Real& x) { return of(mpfr_tan, x); }
Real exp(const Real& x) { return of(mpfr_exp, x); }
Real log(const Real& x) { return of(mpfr_log, x); }
Real log2(const Real& x) { return of(mpfr_log2, x); }
Real log10(const Real& x) { return of(mpfr_log10, x); }
Real acos(const Real& x) { return of(mpfr_acos, x); }
Real atan2(const Real& y, const Real& x) { return of(mpfr_atan2, y, x); }
Real pow(const Real& base, const Real& exponent) { return of(mpfr_pow, base, exponent); }
Real pi() {
  Real x;
  mpfr_const_pi(x.get(), MPFR_RNDN);
  return x;
}

Real exact(const std::function<Real()>& compute) {
  const mpfr_prec_t before = Real::precision;
  Real::precision = 256;
  Real last = compute();
  for (Real::precision = 512; Real::precision <= 1 << 15; Real::precision *= 2) {
    const Real next = compute();
    if (agree(last, next)) {
      Real::precision = before;
      return next;
    }
    last = next;
  }
  Real::precision = before;
  throw std::logic_error("an oracle did not settle within 32768 bits");
}

double ulps(float got, const Real& want) { return ulps_of(got, want); }
double ulps(double got, const Real& want) { return ulps_of(got, want); }

double distance(double got, const Real& want, const Real& scale) {
  if (!std::isfinite(got)) return std::numeric_limits<double>::infinity();
  return abs((Real(got) - want) / scale).to_double();
}
double distance(double got, const Rational& want, const Rational& scale) {
  if (!std::isfinite(got)) return std::numeric_limits<double>::infinity();
  const Rational off = (Rational(got) - want) / scale;
  return std::fabs(off.get_d());
}

}  // namespace frustum::hard
