#pragma once
// Reduction of large angles modulo pi/2, for elementary_trig.h.
// Source: Payne & Hanek 1983, "Radian reduction for trigonometric functions", SIGNUM Newsletter 18:19.

#include <array>
#include <bit>
#include <cstdint>

#include "nodes/kernels/double_double.h"
#include "nodes/kernels/elementary_constants.h"

namespace frustum::kernels::elementary {

// An angle as quadrant * pi/2 + r, |r| <= pi/4 (a hair more), quadrant modulo 4.
struct Reduced {
  TwoTerms<double> r;
  unsigned quadrant;
};

// The first 1280 bits of 2/pi behind the binary point.
inline constexpr std::array<std::uint64_t, 20> two_over_pi_bits = {
    0xa2f9836e4e441529, 0xfc2757d1f534ddc0, 0xdb6295993c439041, 0xfe5163abdebbc561, 0xb7246e3a424dd2e0,
    0x06492eea09d1921c, 0xfe1deb1cb129a73e, 0xe88235f52ebb4484, 0xe99c7026b45f7e41, 0x3991d639835339f4,
    0x9c845f8bbdf9283b, 0x1ff897ffde05980f, 0xef2f118b5a0a6d1f, 0x6d367ecf27cb09b7, 0x4f463f669e5fea2d,
    0x7527bac7ebe5f17b, 0x3d0739f78a5292ea, 0x6bfb5fb11f8d5d08, 0x56033046fc7b6bab, 0xf0cfbc209af4361d};

// 64 of those bits, the first of weight 2^-(start + 1); zeros in front of the point.
constexpr std::uint64_t two_over_pi_window(int start) {
  const auto word = [](int i) {
    return i < 0 || i >= 20 ? 0 : two_over_pi_bits[static_cast<std::size_t>(i)];
  };
  const int i = start >> 6, shift = start & 63;
  return shift == 0 ? word(i) : word(i) << shift | word(i + 1) >> (64 - shift);
}

// Reduces a finite |x| >= 2^20. Of x * 2/pi only the value modulo 4 matters: bits of 2/pi that meet x's
// integer significand at 4 or above drop out, and 192 bits from there leave an error below 2^-137, while no
// double comes nearer to a multiple of pi/2 than 2^-62.
inline Reduced reduce_large(double x) {
  __extension__ using uint128 = unsigned __int128;
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const std::uint64_t significand = (bits & 0xfffffffffffff) | 0x10000000000000;
  const int start = static_cast<int>(bits >> 52 & 0x7ff) - 1075 - 2;

  // value = x * 2/pi mod 4 in units of 2^-190, most significant word first.
  std::array<std::uint64_t, 3> value{};
  uint128 carry = 0;
  for (int i = 2; i >= 0; --i) {
    carry += uint128{significand} * two_over_pi_window(start + 64 * i);
    value[static_cast<std::size_t>(i)] = static_cast<std::uint64_t>(carry);
    carry >>= 64;
  }
  auto quadrant = static_cast<unsigned>(value[0] >> 62);
  value = {value[0] << 2 | value[1] >> 62, value[1] << 2 | value[2] >> 62, value[2] << 2};

  // Round to the nearest quadrant; what remains is a signed fraction of one.
  bool negative = false;
  if (value[0] >> 63 != 0) {
    ++quadrant;
    negative = true;
    const bool carry1 = value[2] == 0, carry0 = carry1 && value[1] == 0;
    value = {~value[0] + (carry0 ? 1 : 0), ~value[1] + (carry1 ? 1 : 0), ~value[2] + 1};
  }
  const int zeros = value[0] != 0 ? std::countl_zero(value[0]) : 63;
  const auto high = zeros == 0 ? value[0] : value[0] << zeros | value[1] >> (64 - zeros);
  const auto next = zeros == 0 ? value[1] : value[1] << zeros | value[2] >> (64 - zeros);
  const double unit = std::bit_cast<double>(static_cast<std::uint64_t>(1023 - 53 - zeros) << 52);
  const double hi = static_cast<double>(high >> 11) * unit;
  const double lo = static_cast<double>((high & 0x7ff) << 42 | next >> 22) * (unit * 0x1p-53);
  const auto r = product<double>({hi, lo}, {2 * quarter_pi_hi, 2 * quarter_pi_lo});
  const bool flip = negative != (x < 0);
  return {flip ? TwoTerms<double>{-r.hi, -r.lo} : r, (x < 0 ? 0 - quadrant : quadrant) & 3U};
}

}  // namespace frustum::kernels::elementary
