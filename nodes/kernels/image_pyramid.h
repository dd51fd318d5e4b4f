// Pyramids of images, each a half of the one before.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace frustum::kernels {

// The part of texel `from` of n that lies in cell `to` of m <= n, in units of 1 / n: cells are n / m texels
// wide.
struct CellSpan {
  int first, last;  // texels, inclusive
  double first_part,
      last_part;  // of the first and last; 1 between them; where they are one texel, first_part holds
};
inline CellSpan cell_span(int to, int n, int m) {
  // Ends in units of 1 / (n m): exact integers.
  const long long begin = static_cast<long long>(to) * n, end = begin + n;
  const int first = static_cast<int>(begin / m), last = static_cast<int>((end - 1) / m);
  const auto part = [&](long long a, long long b) { return static_cast<double>(b - a) / m; };
  if (first == last) return {first, last, part(begin, end), 0};
  return {first, last, part(begin, (first + 1LL) * m), part(static_cast<long long>(last) * m, end)};
}

// Row `y` of the next level of a picture of width x height RGBA texels: averages over cells of exact area,
// each side halved (rounding down, at least 1). Sums are double, in order of rows, then columns.
//   to   max(1, width / 2) x 4
inline void halve_row(std::span<const float> rgba, int width, int height, int y, std::span<float> to) {
  const int w = std::max(1, width / 2), h = std::max(1, height / 2);
  const CellSpan rows = cell_span(y, height, h);
  for (int x = 0; x < w; ++x) {
    const CellSpan columns = cell_span(x, width, w);
    double sum[4] = {}, area = 0;
    for (int v = rows.first; v <= rows.last; ++v) {
      const double part_v = v == rows.first ? rows.first_part : v == rows.last ? rows.last_part : 1;
      for (int u = columns.first; u <= columns.last; ++u) {
        const double part = part_v * (u == columns.first  ? columns.first_part
                                      : u == columns.last ? columns.last_part
                                                          : 1);
        const float* texel = &rgba[4 * (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                                        static_cast<std::size_t>(u))];
        for (int k = 0; k < 4; ++k) sum[k] += part * static_cast<double>(texel[k]);
        area += part;
      }
    }
    for (std::size_t k = 0; k < 4; ++k)
      to[4 * static_cast<std::size_t>(x) + k] = static_cast<float>(sum[k] / area);
  }
}

}  // namespace frustum::kernels
