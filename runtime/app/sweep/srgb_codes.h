// Light as the 8 bits of an sRGB display, by a table: thumbnails of a sweep have a million of such numbers, and a power of
// each took longer than some graphs.
#pragma once

#include "nodes/kernels/transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace frustum {

// What the table holds, by the formula: the nearest of 256 codes, of numbers beyond 0 and 1 the first and the last.
inline int srgb_code_by_formula(double light) {
  return static_cast<int>(std::clamp(kernels::encode(kernels::Curve::srgb, light), 0.0, 1.0) * 255 + 0.5);
}

// The same function, and 0 for NaN. Made once: some 1500 powers, less than a thumbnail has.
class SrgbCodes {
 public:
  SrgbCodes() {
    for (std::size_t k = 0; k < least_.size(); ++k) {
      const int code = static_cast<int>(k) + 1;
      double v = kernels::decode(kernels::Curve::srgb, (static_cast<double>(code) - 0.5) / 255);
      while (srgb_code_by_formula(v) < code) v = std::nextafter(v, 2.0);
      for (double less; srgb_code_by_formula(less = std::nextafter(v, 0.0)) >= code;) v = less;
      least_[k] = v;
    }
    for (std::size_t i = 0, k = 0; i < first_.size(); ++i) {
      while (k < least_.size() && least_[k] <= static_cast<double>(i) / bins) ++k;
      first_[i] = static_cast<std::uint8_t>(k);
    }
  }

  // No bin has more than one step: the curve is steepest at 0, where codes are 1/3294 apart.
  int operator()(double light) const {
    if (!(light > 0)) return 0;
    std::size_t k = first_[static_cast<std::size_t>(std::min(light, 1.0) * bins)];
    while (k < least_.size() && light >= least_[k]) ++k;
    return static_cast<int>(k);
  }

 private:
  static constexpr int bins = 4096;
  std::array<double, 255> least_;             // light of code k + 1 and above
  std::array<std::uint8_t, bins + 1> first_;  // the code where a bin begins
};

}  // namespace frustum
