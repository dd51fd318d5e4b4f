// The plane r + g + b = 1, which cuts the cube of colours in Maxwell's triangle.
#pragma once

#include "nodes/kernels/chromaticity.h"

namespace frustum::color {

// Where the line from black through a colour meets the plane; the corners of the triangle are red, green and blue,
// and (1/3, 1/3, 1/3) stands in for black, which has no such point.
// Source: Maxwell 1860, "On the theory of compound colours", doi:10.1098/rstl.1860.0005; errata E55.
template <std::floating_point R>
kernels::Chromaticity<R> on_chroma_plane(const std::array<R, 3>& rgb) {
  constexpr R third = R(1) / R(3);
  return kernels::chromaticity<R>(rgb, {third, third, third});
}

}  // namespace frustum::color
