// Numbers of IEEE binary16: 11 bits, from 2^-24 to 65504.
#pragma once

#include <glm/gtc/packing.hpp>

#include <cstdint>

namespace frustum::kernels {

inline constexpr float most_half = 65504;

/// The nearest binary16 of a number, of two as near the one further from 0; NaN stays NaN. Within 2^-11 of the
/// number itself where that is at least 2^-14, within 2^-25 below. Requires |x| <= most_half, or NaN.
inline std::uint16_t to_half(float x) { return glm::packHalf1x16(x); }

/// Exact.
inline float from_half(std::uint16_t bits) { return glm::unpackHalf1x16(bits); }

}  // namespace frustum::kernels
