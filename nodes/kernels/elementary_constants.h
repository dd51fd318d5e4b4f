#pragma once
// Coefficients of nodes/kernels/elementary*.h, shared by the scalar functions and their highway twins.
//
// Each polynomial interpolates its function at Chebyshev nodes, computed with 60 digits and rounded once;
// the truncation error stands beside it. hi + lo pairs hold 106 bits of a constant.

#include <array>

namespace frustum::kernels::elementary {

inline constexpr double ln2_hi = 0x1.62e42fefa39efp-1, ln2_lo = 0x1.abc9e3b39803fp-56;
inline constexpr double log2_e_hi = 0x1.71547652b82fep+0, log2_e_lo = 0x1.777d0ffda0d24p-56;
inline constexpr double quarter_pi_hi = 0x1.921fb54442d18p-1, quarter_pi_lo = 0x1.1a62633145c07p-55;
inline constexpr double radians_hi = 0x1.1df46a2529d39p-6, radians_lo = 0x1.5c1d8becdd291p-62;  // pi / 180
inline constexpr double two_over_pi = 0x1.45f306dc9c883p-1;
inline constexpr double sqrt_half = 0x1.6a09e667f3bcdp-1;

// Adding it rounds |x| < 2^51 to an integer (ties to even) and leaves that integer, plus the bias of a
// double's exponent, in the low bits of the sum.
inline constexpr double round_to_integer = 0x1.8p52;
inline constexpr double round_to_exponent = 0x1.8p52 + 1023;

// pi/2 in three parts of 33 bits and one of 53: q * part is exact for integers |q| < 2^20.
inline constexpr std::array half_pi = {0x1.921fb54400000p+0, 0x1.0b4611a600000p-34, 0x1.3198a2e000000p-69,
                                       0x1.b839a252049c1p-104};

// 2^r = 1 + r ln 2 + r^2 Q(r), |r| <= 1/2; relative error of 2^r below 2^-62.
inline constexpr std::array exp2_tail = {0x1.ebfbdff82c58fp-3,  0x1.c6b08d704a0c2p-5,  0x1.3b2ab6fba4e78p-7,
                                         0x1.5d87fe78a5276p-10, 0x1.430912f86bf52p-13, 0x1.ffcbfc670dd82p-17,
                                         0x1.62c022401b9c2p-20, 0x1.b524fae606540p-24, 0x1.e4cf1cd073038p-28,
                                         0x1.e9d3fe7bb0db4p-32, 0x1.c48f76cf62f19p-36};

// 2^r = 1 + r Q(r), |r| <= 1/2, for float results; relative error below 2^-33.
inline constexpr std::array exp2_short = {0x1.62e42fefa39efp-1, 0x1.ebfbe045f50e2p-3,  0x1.c6b08d883ddc0p-5,
                                          0x1.3b2a1b7104e43p-7, 0x1.5d879eacd6b77p-10, 0x1.44400016ea23dp-13,
                                          0x1.00a5818938e35p-16};

// log2((1 + s) / (1 - s)) = s (C0 + z (C1 + z W(z))), z = s^2, m = (1 + s) / (1 - s) in [sqrt 1/2, sqrt 2];
// relative error below 2^-70.
inline constexpr double log2_c0_hi = 0x1.71547652b82fep+1, log2_c0_lo = 0x1.777d0ffda0d24p-55;  // 2 / ln 2
inline constexpr double log2_c1_hi = 0x1.ec709dc3a03fdp-1, log2_c1_lo = 0x1.d27f05548af0cp-55;  // C0 / 3
inline constexpr std::array log2_tail = {0x1.2776c50ef9bfep-1, 0x1.a61762a7adfa8p-2, 0x1.484b13d79c410p-2,
                                         0x1.0c9a84bf4b88cp-2, 0x1.c68f2f05fbc79p-3, 0x1.89fed19a1b9bdp-3,
                                         0x1.59e09fb057ee4p-3, 0x1.5a5fb75008764p-3};

// The same with s (C0 + z W(z)), for float results; relative error below 2^-43.
inline constexpr std::array log2_short = {0x1.ec709dc3b6b97p-1, 0x1.2776c479ef0a3p-1, 0x1.a6189e3f00981p-2,
                                          0x1.47d6834d15059p-2, 0x1.1e0c5d8eb28e1p-2};

// sin x = x + x^3 S(z), cos x = 1 - z/2 + z^2 C(z), z = x^2, |x| <= pi/4; errors below 2^-66 and 2^-60.
inline constexpr std::array sin_tail = {-0x1.5555555555555p-3, 0x1.1111111111110p-7,   -0x1.a01a01a019938p-13,
                                        0x1.71de3a5460950p-19, -0x1.ae645412c4390p-26, 0x1.61217f0a95ad6p-33,
                                        -0x1.ab17d37ab5989p-41};
inline constexpr std::array cos_tail = {0x1.5555555555555p-5,  -0x1.6c16c16c16967p-10,
                                        0x1.a01a019f4eaf9p-16, -0x1.27e4fa17d9624p-22,
                                        0x1.1eeb68e88cbb9p-29, -0x1.907da2e9cd397p-37};

// atan u = u + u^3 A(u^2), |u| <= tan(pi/8); relative error below 2^-62.
inline constexpr std::array atan_tail = {-0x1.5555555555555p-2, 0x1.9999999999953p-3,  -0x1.249249248d7edp-3,
                                         0x1.c71c71c304ac7p-4,  -0x1.745d165df2041p-4, 0x1.3b1392d9aee9bp-4,
                                         -0x1.110e88068190cp-4, 0x1.e19a135ea72c7p-5,  -0x1.ac7a90eabcecfp-5,
                                         0x1.74ddc80c4d405p-5,  -0x1.1b339a5048955p-5, 0x1.0ad325f270444p-6};

}  // namespace frustum::kernels::elementary
