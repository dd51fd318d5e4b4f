// The pixels that hang together with a seed, by spans and without recursion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frustum::fill {

// A run of pixels of one row, x1 excluded.
struct Span {
  int y, x0, x1;
  bool operator==(const Span&) const = default;
};

enum class Connectivity : std::uint8_t { four, eight };

struct Filled {
  std::vector<Span> spans;   // in the order in which they were filled
  std::uint64_t pixels = 0;  // in them
  std::uint64_t tests = 0;   // of pixels: at most some four for each of `pixels`
  std::size_t deepest = 0;   // spans that waited at the same time, at most
};

// Which pixels were filled, one bit each.
class Marks {
 public:
  Marks(int width, int height)
      : width_(static_cast<std::size_t>(width)),
        bits_((width_ * static_cast<std::size_t>(height) + 63) / 64) {}
  bool at(int x, int y) const { return (bits_[index(x, y) / 64] >> (index(x, y) % 64) & 1) != 0; }
  void set(int x, int y) { bits_[index(x, y) / 64] |= std::uint64_t{1} << (index(x, y) % 64); }
  std::size_t bytes() const { return bits_.size() * sizeof bits_[0]; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x);
  }
  std::size_t width_;
  std::vector<std::uint64_t> bits_;
};

// Fills what can be reached from the seed through pixels for which inside(x, y) holds, over their sides or
// also over their corners; nothing where it does not hold for the seed. inside() may say anything of any
// pixel: what is filled is remembered apart from the colours, so that the fill ends whatever they are.
//   Requires a seed in [0, width) x [0, height). `poll` is called once a span.
// Every span looks once at the rows above and below it, so the cost is O(pixels), the memory one bit a pixel
// and the spans that wait. Source: Smith 1979, "Tint fill", SIGGRAPH 13(2):276; Heckbert 1990, Graphics Gems.
template <class Inside, class Poll>
Filled spans_from(int width, int height, int seed_x, int seed_y, Connectivity connectivity,
                  const Inside& inside, const Poll& poll) {
  Filled out;
  Marks marks(width, height);
  std::vector<Span> waiting;
  const int corner = connectivity == Connectivity::eight ? 1 : 0;
  const auto open = [&](int x, int y) {
    ++out.tests;
    return !marks.at(x, y) && inside(x, y);
  };
  // The whole run around an open pixel.
  const auto take = [&](int x, int y) {
    Span s{y, x, x + 1};
    while (s.x0 > 0 && open(s.x0 - 1, y)) --s.x0;
    while (s.x1 < width && open(s.x1, y)) ++s.x1;
    for (int i = s.x0; i < s.x1; ++i) marks.set(i, y);
    out.spans.push_back(s);
    out.pixels += static_cast<std::uint64_t>(s.x1 - s.x0);
    waiting.push_back(s);
    return s.x1;
  };
  if (!open(seed_x, seed_y)) return out;
  take(seed_x, seed_y);
  while (!waiting.empty()) {
    poll();
    out.deepest = waiting.size() > out.deepest ? waiting.size() : out.deepest;
    const Span s = waiting.back();
    waiting.pop_back();
    for (const int y : {s.y - 1, s.y + 1}) {
      if (y < 0 || y >= height) continue;
      const int end = s.x1 + corner < width ? s.x1 + corner : width;
      for (int x = s.x0 - corner > 0 ? s.x0 - corner : 0; x < end; ++x)
        if (open(x, y)) x = take(x, y);
    }
  }
  return out;
}

}  // namespace frustum::fill
