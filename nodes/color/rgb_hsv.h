// Hue, saturation and value of colours, for all real numbers.
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <limits>

namespace frustum::color {

// h in [0, 360) degrees, s = (max - min) / max, v = max. Grey has h = 0 and s = 0, black v = 0 as well. With
// numbers below 0 the formulas go on: s is above 1 where the greatest is above 0, and negative where it is below;
// s is infinite where the greatest is 0 and another one below, which no h, s, v stands for. v above 1 is as
// good as any. One NaN makes three.
// Source: Smith 1978, "Color gamut transform pairs", doi:10.1145/965139.807361.
template <std::floating_point R>
std::array<R, 3> hsv_of_rgb(const std::array<R, 3>& rgb) {
  const R r = rgb[0], g = rgb[1], b = rgb[2];
  if (std::isnan(r) || std::isnan(g) || std::isnan(b)) {
    constexpr R nan = std::numeric_limits<R>::quiet_NaN();
    return {nan, nan, nan};
  }
  const R most = r > g ? (r > b ? r : b) : (g > b ? g : b), least = r < g ? (r < b ? r : b) : (g < b ? g : b);
  const R chroma = most - least;
  if (chroma == 0) return {R(0), R(0), most};
  // One rounding of an angle: the anchors 0, 120, 240 and 360 are exact.
  R h;
  if (most == r)
    h = g >= b ? 60 * ((g - b) / chroma) : 360 - 60 * ((b - g) / chroma);
  else if (most == g)
    h = 120 + 60 * ((b - r) / chroma);
  else
    h = 240 + 60 * ((r - g) / chroma);
  return {h >= 360 ? R(0) : h, chroma / most, most};
}

// The inverse: for any hue, which goes around at 360 and may be negative, and for any s and v; a hue that is
// NaN or infinite makes three NaN. A colour comes back to within 8 u of its greatest magnitude or, where that is
// more, of max - min (u: half a unit in the last place of 1), greys bit by bit. Where the greatest number is less
// than 2^-10 of another one the difference is all that s has, and more is lost.
template <std::floating_point R>
std::array<R, 3> rgb_of_hsv(const std::array<R, 3>& hsv) {
  const R s = hsv[1], v = hsv[2];
  R h = hsv[0];
  if (!(h >= 0 && h < 360)) {
    h = std::fmod(h, R(360));  // exact, on every processor
    if (h < 0) h += 360;
    if (h >= 360) h = 0;
    if (std::isnan(h)) return {h, h, h};
  }
  const R chroma = v * s, least = v - chroma;
  // From the nearest colour of one number; exact, since h is within a factor 2 of the anchor.
  const R anchor = h < 60 ? R(0) : h < 180 ? R(120) : h < 300 ? R(240) : R(360);
  const R away = (h - anchor) / 60;
  const R middle = v - chroma * (1 - std::abs(away));
  const R up = away >= 0 ? middle : least, down = away >= 0 ? least : middle;
  if (h < 60 || h >= 300) return {v, up, down};
  if (h < 180) return {down, v, up};
  return {up, down, v};
}

}  // namespace frustum::color
