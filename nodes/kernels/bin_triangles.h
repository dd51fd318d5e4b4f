// Sorts screen triangles into square bins, so that any rectangle of pixels finds the few that may cover it.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "nodes/kernels/box_triangles.h"

namespace frustum::kernels {

// A triangle in a bin and the pixels of the bin that its bounding box touches, both ends included.
struct BinEntry {
  std::uint32_t face;
  std::uint8_t x0, y0, x1, y1;
  bool operator==(const BinEntry&) const = default;
};

struct TriangleBins {
  static constexpr int size = 64;  // px; BinEntry counts them in 8 bits

  PixelRect window{};
  int columns = 0, rows = 0;
  std::vector<std::uint64_t> first;  // per bin its first entry, row by row, and the end
  std::vector<BinEntry> entries;     // of one bin in drawing order: ascending (origin, face)
  std::uint64_t out_of_range = 0;    // triangles left out: a corner is NaN, infinite or out of range
  std::uint64_t without_area = 0;    // triangles left out: their snapped corners lie on a line

  std::span<const BinEntry> bin(int column, int row) const {
    const auto i =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
    return std::span(entries).subspan(first[i], first[i + 1] - first[i]);
  }
};

// Bins every triangle that may cover a sample of the window; those whose bounding box misses all samples are
// left out, and so are bins that lie outside one of a large triangle's edges.
//   window  at most 65536 px wide and high, within +-65536 px
//   claim   called with bytes of memory before they are taken; may throw
// The result does not depend on the number of threads. Memory: O(triangles + bins + entries); an entry is 8
// bytes, and a triangle has one in every bin that its bounding box touches and its edges do not exclude.
// Parallel with oneTBB.
template <std::floating_point R>
TriangleBins bin_triangles(const ScreenMesh<R>& mesh, const SamplePositions& pattern, PixelRect window,
                           const std::function<void(std::uint64_t)>& claim = {});

}  // namespace frustum::kernels
