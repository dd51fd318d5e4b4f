// What the scanline algorithm does, looked at: its work over a whole picture, and one line span by span.
#pragma once

#include <vector>

#include "nodes/kernels/scan_lines.h"

namespace frustum::scanline {

struct Survey {
  Counts counts;                  // of all lines
  std::vector<Segment> segments;  // of the line that was asked for, from left to right
};

// Runs over the picture in bands of rows, so that memory is O(width), and throws the pixels away.
//   row   whose segments are kept, of the first sample; outside the window: none
//   poll  called once a band; may throw
template <std::floating_point R, class Poll>
Survey survey(const Scanner<R>& scanner, PixelRect window, int row, const Poll& poll) {
  constexpr int band = kernels::TriangleBins::size;
  const int width = window.x1 - window.x0;
  const auto samples = static_cast<std::size_t>(scanner.samples());
  const auto pixels = static_cast<std::size_t>(width) * band;
  std::vector<std::uint32_t> id(pixels * samples);
  std::vector<R> z(pixels * samples);
  const auto stride = static_cast<std::ptrdiff_t>(pixels);
  Survey out;
  for (int y = window.y0; y < window.y1; y += band) {
    poll();
    const Watch watch{&out.counts, [&](const Segment& s) {
                        if (s.row == row && s.sample == 0) out.segments.push_back(s);
                      }};
    scanner.fill({window.x0, y, window.x1, std::min(y + band, window.y1)}, {id.data(), width, stride},
                 {z.data(), width, stride}, watch);
  }
  return out;
}

}  // namespace frustum::scanline
