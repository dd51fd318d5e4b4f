#pragma once
// The elementary functions of every kernel that fills a buffer. libm's last bits change with the processor
// (glibc picks FMA variants at run time); these use + - * /, sqrt, comparisons and bit operations only, each
// rounded as IEEE 754 says, so their bits are the same everywhere. simd/elementary-inl.h has the twins.
//
// Call them qualified (kernels::exp): an unqualified exp may find libm's.
//
// Float functions compute in double and round once. Every NaN result is the one quiet NaN.
// Largest errors against 80-bit libm, over the ranges of tests/nodes/kernels/elementary_test.cpp, in ulp:
//
//            exp   exp2  log   log2  pow   sin   cos   tan   asin  acos  atan2
//   float    .502  .502  .501  .501  .502  .501  .501  .501  .501  .501  .501
//   double   .90   .85   .51   .51   .90   .80   .80   1.00  .66   .64   .65   (subnormal results: 1)
//
// Special values follow C17 annex F.

#include "nodes/kernels/elementary_exp.h"
#include "nodes/kernels/elementary_trig.h"
