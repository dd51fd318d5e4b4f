#pragma once
// Error-free transformations: a rounded sum or product together with exactly what rounding took away.
// Exact only while the compiler neither contracts nor reorders (-ffp-contract=off, no fast-math) and
// nothing over- or underflows.
// Source: Dekker 1971, Numer. Math. 18:224; Knuth, TAOCP 2, section 4.2.2; Ogita, Rump & Oishi 2005.

#include <concepts>
#include <type_traits>

namespace frustum::kernels {

// The unevaluated sum hi + lo, with |lo| <= ulp(hi)/2 when it comes from the functions below.
template <std::floating_point R>
struct TwoTerms {
  R hi;
  R lo;
};

// a + b exactly. Any a, b.
template <std::floating_point R>
constexpr TwoTerms<R> two_sum(R a, R b) {
  const R s = a + b;
  const R b_part = s - a;
  return {s, (a - (s - b_part)) + (b - b_part)};
}

// a + b exactly. Requires |a| >= |b| or a = 0.
template <std::floating_point R>
constexpr TwoTerms<R> fast_two_sum(R a, R b) {
  const R s = a + b;
  return {s, b - (s - a)};
}

// a as the sum of two numbers of at most half the digits each, so that their products are exact.
// Requires |a| < 2^995 (float: 2^115): the multiplier must not overflow.
template <std::floating_point R>
constexpr TwoTerms<R> split(R a) {
  constexpr R multiplier = sizeof(R) == 8 ? R(134217729) : R(4097);  // 2^27 + 1, 2^12 + 1
  const R scaled = multiplier * a;
  const R hi = scaled - (scaled - a);
  return {hi, a - hi};
}

// a * b exactly, by Dekker's product: the same bits as with std::fma, and inline on every processor.
// Requires |a|, |b| < 2^995 and |a b| > 2^-969 (float: 2^115, 2^-102), or a b = 0.
template <std::floating_point R>
constexpr TwoTerms<R> two_product(R a, R b) {
  const R p = a * b;
  const auto [ah, al] = split(a);
  const auto [bh, bl] = split(b);
  return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

// (a.hi + a.lo) + (b.hi + b.lo) with an error below 2^-104 (|a| + |b|) (double).
template <std::floating_point R>
constexpr TwoTerms<R> plus(TwoTerms<R> a, std::type_identity_t<TwoTerms<R>> b) {
  const auto s = two_sum(a.hi, b.hi);
  return fast_two_sum(s.hi, s.lo + (a.lo + b.lo));
}

// (a.hi + a.lo)(b.hi + b.lo) with a relative error below 2^-102 (double).
template <std::floating_point R>
constexpr TwoTerms<R> product(TwoTerms<R> a, std::type_identity_t<TwoTerms<R>> b) {
  const auto p = two_product(a.hi, b.hi);
  return fast_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

// (n.hi + n.lo) / (d.hi + d.lo) with a relative error below 2^-100 (double). Requires d.hi != 0.
template <std::floating_point R>
constexpr TwoTerms<R> quotient(TwoTerms<R> n, std::type_identity_t<TwoTerms<R>> d) {
  const R q = n.hi / d.hi;
  const auto p = two_product(q, d.hi);
  return fast_two_sum(q, (((n.hi - p.hi) - p.lo) + (n.lo - q * d.lo)) / d.hi);
}

}  // namespace frustum::kernels
