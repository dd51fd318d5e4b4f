// Lists of fragments: at every sample of every pixel all that was found there, from the front to the back.
#pragma once

#include "runtime/buffers/column.h"
#include "runtime/core/frame.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace frustum {

// The lists of an A-buffer, and the pixels of a deep picture. Channels are named as in deep EXR files:
//   Z      real  depth, or where a fragment that fills a range of depths begins
//   ZBack  real  where it ends
//   id     u32   the face
//   R G B A      colour, premultiplied by A
// and any other name. Every channel has one number a fragment.
struct Fragments {
  Rect window = {};                 // absolute pixels; row 0 on top
  Ref<SamplePattern> pattern = {};  // null: one list a pixel
  std::vector<std::uint64_t> first = {
      0};  // of each list its first fragment, row by row, sample by sample; and the end
  std::vector<Ref<Column>> channels = {};  // width 1, f32, f64 or u32, of domain vertex: a row a fragment
  std::string color_space = {};            // of R, G, B; empty where there are none

  struct Range {
    std::size_t begin, end;
  };
  int samples() const { return pattern ? pattern->samples : 1; }
  std::size_t lists() const { return first.size() - 1; }
  std::size_t count() const { return static_cast<std::size_t>(first.back()); }
  std::size_t list(int sample, int x, int y) const {
    const auto row = static_cast<std::size_t>(y - window.y0),
               column = static_cast<std::size_t>(x - window.x0);
    return (row * static_cast<std::size_t>(window.width()) + column) * static_cast<std::size_t>(samples()) +
           static_cast<std::size_t>(sample);
  }
  Range of_list(std::size_t list) const {
    return {static_cast<std::size_t>(first[list]), static_cast<std::size_t>(first[list + 1])};
  }
  // Those of all samples of a pixel, which lie one behind the other.
  Range of_pixel(int x, int y) const {
    const std::size_t at = list(0, x, y);
    return {static_cast<std::size_t>(first[at]),
            static_cast<std::size_t>(first[at + static_cast<std::size_t>(samples())])};
  }
  const Column* find(std::string_view channel) const {
    for (const Ref<Column>& c : channels)
      if (c->name() == channel) return c.get();
    return nullptr;
  }
};

// What is wrong with the shape of the lists, as a sentence; empty where it is right.
std::string fault_of(const Fragments&);

template <>
const BufferType& buffer_type<Fragments>();

}  // namespace frustum
