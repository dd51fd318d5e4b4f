// exp, exp2, log, log2 and pow on highway vectors of float. Scalar twin: nodes/kernels/elementary_exp.h,
// whose operations these repeat one by one, so that each lane has the scalar function's bits on every target.
//
// Include inside a file that uses hwy/foreach_target.h, then call frustum::HWY_NAMESPACE::pow(d, x, y) and so
// on. No MulAdd anywhere: it rounds once with FMA and twice without.

#if defined(FRUSTUM_KERNELS_SIMD_ELEMENTARY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FRUSTUM_KERNELS_SIMD_ELEMENTARY_INL_H
#undef FRUSTUM_KERNELS_SIMD_ELEMENTARY_INL_H
#else
#define FRUSTUM_KERNELS_SIMD_ELEMENTARY_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>

#include "nodes/kernels/elementary.h"

HWY_BEFORE_NAMESPACE();
namespace frustum::HWY_NAMESPACE {
namespace elementary_detail {

namespace hn = hwy::HWY_NAMESPACE;
namespace scalar = frustum::kernels::elementary;

#if HWY_TARGET != HWY_SCALAR

template <class D, std::size_t N>
HWY_INLINE hn::Vec<D> horner(D d, const std::array<double, N>& c, hn::Vec<D> x) {
  auto sum = hn::Set(d, c[N - 1]);
  for (std::size_t i = N - 1; i-- > 0;) sum = hn::Add(hn::Mul(sum, x), hn::Set(d, c[i]));
  return sum;
}

template <class D>
HWY_INLINE hn::Vec<D> nearest_integer(D d, hn::Vec<D> x) {
  const auto magic = hn::Set(d, scalar::round_to_integer);
  return hn::Sub(hn::Add(x, magic), magic);
}

template <class D>
HWY_INLINE hn::Vec<D> power_of_two(D d, hn::Vec<D> n) {
  const hn::RebindToUnsigned<D> du;
  return hn::BitCast(d,
                     hn::ShiftLeft<52>(hn::BitCast(du, hn::Add(n, hn::Set(d, scalar::round_to_exponent)))));
}

// NaN lanes give an unspecified number; callers replace them.
template <class D>
HWY_INLINE hn::Vec<D> exp2_short_of(D d, hn::Vec<D> x) {
  const auto clamped = hn::Min(hn::Max(x, hn::Set(d, -200.0)), hn::Set(d, 200.0));
  const auto n = nearest_integer(d, clamped);
  const auto r = hn::Sub(clamped, n);
  const auto power = hn::Add(hn::Set(d, 1.0), hn::Mul(r, horner(d, scalar::exp2_short, r)));
  return hn::Mul(power, power_of_two(d, n));
}

template <class D>
HWY_INLINE hn::Vec<D> log2_short_any(D d, hn::Vec<D> x) {
  const hn::RebindToSigned<D> di;
  const auto bits = hn::BitCast(di, x);
  const auto offset = hn::BitCast(di, hn::Set(d, scalar::sqrt_half));
  // k = (bits - offset) >> 52 as a double: the shifted bits land in the significand of 1.5 * 2^52.
  const auto k_bits = hn::ShiftRight<52>(hn::Sub(bits, offset));
  const auto magic = hn::Set(d, scalar::round_to_integer);
  const auto k = hn::Sub(hn::BitCast(d, hn::Add(k_bits, hn::BitCast(di, magic))), magic);
  const auto m = hn::BitCast(d, hn::Sub(bits, hn::ShiftLeft<52>(k_bits)));
  const auto one = hn::Set(d, 1.0);
  const auto s = hn::Div(hn::Sub(m, one), hn::Add(m, one));
  const auto z = hn::Mul(s, s);
  const auto series = hn::Add(hn::Set(d, scalar::log2_c0_hi), hn::Mul(z, horner(d, scalar::log2_short, z)));
  auto log = hn::Add(k, hn::Mul(s, series));
  const auto infinity = hn::Set(d, scalar::infinity), zero = hn::Zero(d);
  log = hn::IfThenElse(hn::Eq(x, infinity), infinity, log);
  log = hn::IfThenElse(hn::Eq(x, zero), hn::Neg(infinity), log);
  return hn::IfThenElse(hn::Ge(x, zero), log, hn::Set(d, scalar::nan));
}

template <class D>
HWY_INLINE hn::Vec<D> pow_short(D d, hn::Vec<D> x, hn::Vec<D> y) {
  const auto one = hn::Set(d, 1.0), zero = hn::Zero(d), half = hn::Set(d, 0.5);
  const auto base = hn::Abs(x);
  auto power = exp2_short_of(d, hn::Mul(y, log2_short_any(d, base)));
  power = hn::IfThenElse(hn::Eq(base, one), one, power);

  // A negative base: floats from 2^24 on are even integers, and so is infinity here.
  const auto large = hn::Ge(hn::Abs(y), hn::Set(d, 0x1p25));
  const auto whole = hn::Or(large, hn::Eq(nearest_integer(d, y), y));
  const auto twice_half = hn::Add(nearest_integer(d, hn::Mul(y, half)), nearest_integer(d, hn::Mul(y, half)));
  const auto odd = hn::AndNot(large, hn::And(whole, hn::Ne(twice_half, y)));
  const auto negative = hn::Lt(hn::CopySign(one, x), zero);
  power = hn::IfThenElse(hn::And(negative, odd), hn::Neg(power), power);
  const auto bounded = hn::And(hn::Gt(base, zero), hn::Lt(base, hn::Set(d, scalar::infinity)));
  const auto undefined = hn::And(hn::AndNot(whole, negative), bounded);
  const auto unordered = hn::Or(hn::IsNaN(x), hn::IsNaN(y));
  power = hn::IfThenElse(hn::Or(undefined, unordered), hn::Set(d, scalar::nan), power);
  return hn::IfThenElse(hn::Or(hn::Eq(y, zero), hn::Eq(x, one)), one, power);
}

// Applies f to the float lanes in double, a half at a time, and rounds once.
template <class D, class F, class... V>
HWY_INLINE hn::Vec<D> in_double(D d, F f, V... v) {
  const hn::Half<D> dh;
  const hn::RepartitionToWide<D> dd;
  const auto low = f(dd, hn::PromoteTo(dd, hn::LowerHalf(dh, v))...);
  const auto high = f(dd, hn::PromoteTo(dd, hn::UpperHalf(dh, v))...);
  return hn::Combine(d, hn::DemoteTo(dh, high), hn::DemoteTo(dh, low));
}

template <class D>
HWY_INLINE hn::Vec<D> nan_where(D d, hn::Mask<D> mask, hn::Vec<D> v) {
  return hn::IfThenElse(mask, hn::Set(d, scalar::nan), v);
}

#endif  // HWY_TARGET != HWY_SCALAR

}  // namespace elementary_detail

#if HWY_TARGET != HWY_SCALAR

// 2^x in each lane.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> exp2(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  namespace e = elementary_detail;
  const auto f = [](auto dd, auto v)
                     HWY_ATTR { return e::nan_where(dd, e::hn::IsNaN(v), e::exp2_short_of(dd, v)); };
  return e::in_double(d, f, x);
}

// e^x in each lane.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> exp(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  namespace e = elementary_detail;
  const auto f = [](auto dd, auto v) HWY_ATTR {
    const auto scaled = e::hn::Mul(v, e::hn::Set(dd, e::scalar::log2_e_hi));
    return e::nan_where(dd, e::hn::IsNaN(v), e::exp2_short_of(dd, scaled));
  };
  return e::in_double(d, f, x);
}

// log2 of each lane.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> log2(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  namespace e = elementary_detail;
  return e::in_double(
      d, [](auto dd, auto v) HWY_ATTR { return e::log2_short_any(dd, v); }, x);
}

// Natural logarithm of each lane.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> log(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  namespace e = elementary_detail;
  const auto f = [](auto dd, auto v) HWY_ATTR {
    const auto log = e::hn::Mul(e::log2_short_any(dd, v), e::hn::Set(dd, e::scalar::ln2_hi));
    return e::nan_where(dd, e::hn::IsNaN(log), log);
  };
  return e::in_double(d, f, x);
}

// x^y in each lane.
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> pow(D d, hwy::HWY_NAMESPACE::Vec<D> x, hwy::HWY_NAMESPACE::Vec<D> y) {
  namespace e = elementary_detail;
  return e::in_double(
      d, [](auto dd, auto a, auto b) HWY_ATTR { return e::pow_short(dd, a, b); }, x, y);
}

#else  // one lane: the scalar twin itself

template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> exp2(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  return hwy::HWY_NAMESPACE::Set(d, kernels::exp2(hwy::HWY_NAMESPACE::GetLane(x)));
}
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> exp(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  return hwy::HWY_NAMESPACE::Set(d, kernels::exp(hwy::HWY_NAMESPACE::GetLane(x)));
}
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> log2(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  return hwy::HWY_NAMESPACE::Set(d, kernels::log2(hwy::HWY_NAMESPACE::GetLane(x)));
}
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> log(D d, hwy::HWY_NAMESPACE::Vec<D> x) {
  return hwy::HWY_NAMESPACE::Set(d, kernels::log(hwy::HWY_NAMESPACE::GetLane(x)));
}
template <class D>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> pow(D d, hwy::HWY_NAMESPACE::Vec<D> x, hwy::HWY_NAMESPACE::Vec<D> y) {
  using hwy::HWY_NAMESPACE::GetLane;
  return hwy::HWY_NAMESPACE::Set(d, kernels::pow(GetLane(x), GetLane(y)));
}

#endif

}  // namespace frustum::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
