// Layers of visibility as lists: of every sample the layers that show a face, one behind the other.
#pragma once

#include "nodes/kernels/fill_triangles.h"
#include "nodes/kernels/parallel.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frustum::listing {

// A picture of `samples` x `layers` planes: layer l of sample s is sample l * samples + s of each plane.
struct Shape {
  int width, height, samples, layers;
};

// Where the list of every sample begins, row by row, pixel by pixel, sample by sample, and the end. A list ends at its
// first layer that shows no face. Cost: one read of the ids.
inline std::vector<std::uint64_t> places_of_lists(const Shape& s,
                                                  kernels::PlaneView<const std::uint32_t> id) {
  const auto row = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.samples);
  std::vector<std::uint64_t> first(row * static_cast<std::size_t>(s.height) + 1, 0);
  kernels::parallel_blocks(static_cast<std::size_t>(s.height), 1, [&](std::size_t y, std::size_t) {
    for (int sample = 0; sample < s.samples; ++sample) {
      std::uint64_t* length = first.data() + y * row + 1 + sample;
      for (int layer = 0; layer < s.layers; ++layer) {
        const std::uint32_t* ids = id.row(layer * s.samples + sample, static_cast<int>(y));
        for (int x = 0; x < s.width; ++x) {
          std::uint64_t& n = length[static_cast<std::ptrdiff_t>(x) * s.samples];
          if (n == static_cast<std::uint64_t>(layer) && ids[x] != kernels::no_face) ++n;
        }
      }
    }
  });
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  return first;
}

// Puts the values of one plane into the lists: to[first[list] + layer].
template <class T>
void gather(const Shape& s, const std::vector<std::uint64_t>& first, kernels::PlaneView<const T> plane,
            T* to) {
  const auto row = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.samples);
  kernels::parallel_blocks(static_cast<std::size_t>(s.height), 1, [&](std::size_t y, std::size_t) {
    for (int layer = 0; layer < s.layers; ++layer)
      for (int sample = 0; sample < s.samples; ++sample) {
        const T* from = plane.row(layer * s.samples + sample, static_cast<int>(y));
        std::size_t list = y * row + static_cast<std::size_t>(sample);
        for (int x = 0; x < s.width; ++x, list += static_cast<std::size_t>(s.samples))
          if (first[list] + static_cast<std::uint64_t>(layer) < first[list + 1])
            to[first[list] + static_cast<std::uint64_t>(layer)] = from[x];
      }
  });
}

}  // namespace frustum::listing
