// Pixels as squares of pixels, to be looked at.
#pragma once

#include <cstddef>

namespace frustum::magnify {

// Of whole numbers, rounded down; Requires b > 0.
constexpr int floor_div(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }

// A row of squares: out[i] is the source pixel of x0 + i, `from` pointing at pixel `from_x0`.
template <class T>
void repeat_row(const T* from, int from_x0, int x0, int x1, int factor, T* out) {
  for (int x = x0; x < x1; ++x) *out++ = from[floor_div(x, factor) - from_x0];
}

// Whether a line between squares is drawn at a place: the first row and column of each square.
constexpr bool on_grid(int x, int y, int factor) {
  return x - floor_div(x, factor) * factor == 0 || y - floor_div(y, factor) * factor == 0;
}

}  // namespace frustum::magnify
