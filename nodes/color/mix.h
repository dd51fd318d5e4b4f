// Two pictures as lamps, or as inks.
#pragma once

#include <concepts>

namespace frustum::color {

// Light of two lamps on one screen: numbers add. Premultiplied; coverage adds up to 1.
// Source: Porter & Duff 1984, plus; W3C Compositing and Blending Level 2, plus-lighter, without its upper bound
// for colours.
template <std::floating_point R>
R added(R a, R b) {
  return a + b;
}
template <std::floating_point R>
R added_coverage(R a, R b) {
  const R sum = a + b;
  return sum > 1 ? R(1) : sum;
}

// Two inks or filters one on the other: each lets through its share of the light, and shares multiply. Premultiplied,
// white where one of them covers nothing; the same whichever is on top.
// Source: W3C Compositing and Blending Level 1, multiply, section 9.1.4: cs (1 - ab) + cb (1 - as) + cs cb.
template <std::floating_point R>
R filtered(R a, R alpha_a, R b, R alpha_b) {
  return (a * (1 - alpha_b) + b * (1 - alpha_a)) + a * b;
}
template <std::floating_point R>
R filtered_coverage(R a, R b) {
  return (a + b) - a * b;
}

}  // namespace frustum::color
