// The chromaticities of the colour spaces that pictures come in.
#pragma once

#include <array>
#include <string_view>

namespace frustum {

// CIE 1931 xy of red, green, blue and white.
struct Primaries {
  std::string_view linear_space;  // the linear colour space of this name
  std::array<double, 8> xy;       // rx ry gx gy bx by wx wy
};

constexpr double d65_x = 0.3127,
                 d65_y = 0.3290;  // as ITU-R BT.709 rounds it; every standard here but ACES uses it

constexpr std::array<Primaries, 6> known_primaries{{
    {"lin_rec709", {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, d65_x, d65_y}},  // ITU-R BT.709-6; also IEC 61966-2-1
    {"lin_rec2020", {0.708, 0.292, 0.170, 0.797, 0.131, 0.046, d65_x, d65_y}},  // ITU-R BT.2020-2
    {"lin_p3d65", {0.680, 0.320, 0.265, 0.690, 0.150, 0.060, d65_x, d65_y}},    // SMPTE EG 432-1, Display P3
    {"lin_adobergb", {0.64, 0.33, 0.21, 0.71, 0.15, 0.06, d65_x, d65_y}},       // Adobe RGB (1998), 2005-05
    {"lin_ap0", {0.73470, 0.26530, 0.0, 1.0, 0.00010, -0.07700, 0.32168, 0.33767}},  // SMPTE ST 2065-1
    {"lin_ap1", {0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767}},  // AMPAS S-2014-004 (ACEScg)
}};

}  // namespace frustum
