// From samples to pixels: which neighbourhoods are flat, and the weighted sums of the others.
#pragma once

#include "nodes/kernels/simd/resolve.h"

#include <concepts>
#include <span>

namespace frustum::resolving {

/// The radius in pixels at which a filter is usually used: box, Bartlett and Mitchell are partitions of unity
/// there.
inline double usual_radius(kernels::FilterKind kind) {
  switch (kind) {
    case kernels::FilterKind::box: return 0.5;
    case kernels::FilterKind::bartlett: return 1;
    case kernels::FilterKind::gaussian: return 1.5;
    case kernels::FilterKind::mitchell: break;
  }
  return 2;
}

// Vector kernels for float, their scalar twins for double.

template <std::floating_point R>
void resolve_row(const kernels::ResolveWeights<R>& weights, const kernels::ResolveRow<R>& row) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::resolve_row(weights, row);
  else
    kernels::resolve_row(weights, row);
}

template <std::floating_point R>
void find_equal_samples(const R* first, int samples, std::ptrdiff_t stride, std::size_t n,
                        std::uint32_t* equal, kernels::BitsOf<R>* bits) {
  if constexpr (sizeof(R) == 4)
    kernels::simd::find_equal_samples(first, samples, stride, n, equal, bits);
  else
    kernels::find_equal_samples(first, samples, stride, n, equal, bits);
}

template <class Bits>
void find_equal_neighbours(const std::uint32_t* equal, const Bits* bits,
                           std::span<const std::ptrdiff_t> distance, std::size_t n, std::uint32_t* out) {
  if constexpr (sizeof(Bits) == 4)
    kernels::simd::find_equal_neighbours(equal, bits, distance, n, out);
  else
    kernels::find_equal_neighbours(equal, bits, distance, n, out);
}

}  // namespace frustum::resolving
