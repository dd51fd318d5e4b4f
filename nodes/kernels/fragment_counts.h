// How many fragments there are, before there is room for them.
#pragma once

#include <vector>

#include "nodes/kernels/fragment_layers.h"

namespace frustum::kernels {

struct FragmentCounts {
  std::uint32_t most = 0;       // fragments at one sample
  std::uint64_t fragments = 0;  // at all of them
  std::uint64_t beyond = 0;     // those farther back than the limit asked for
};

namespace detail {

// Counts what fill_fragments would leave in one bin, 16 samples of it at a time.
template <std::floating_point R, class Rows>
class FragmentCounter {
 public:
  FragmentCounter(const FragmentScene<R>& scene, int column, int row)
      : scene_(scene),
        pattern_(scene.fill.pattern),
        entries_(scene.fill.bins->bin(column, row)),
        corner_(scene.fill.bins->window.x0 + column * size, scene.fill.bins->window.y0 + row * size),
        part_(intersection(scene.fill.bins->window,
                           {corner_.x, corner_.y, corner_.x + size, corner_.y + size})),
        count_(static_cast<std::size_t>(std::min(chunk, pattern_.samples)) * size * stride),
        depth_(size) {
    if (!scene.hides.empty()) rank_.resize(count_.size()), cut_.resize(count_.size());
  }

  FragmentCounts count(std::uint32_t limit) {
    FragmentCounts sum;
    for (first_ = 0; first_ < pattern_.samples; first_ += chunk) {
      end_ = std::min(first_ + chunk, pattern_.samples);
      std::fill(count_.begin(), count_.end(), 0u);
      if (!cut_.empty())
        count_before_cuts();
      else if (pattern_.period == 1)
        count_spans();
      else
        for_depths(false, [&](std::size_t at, int n, std::uint32_t) {
          for (int x = 0; x < n; ++x)
            count_[at + static_cast<std::size_t>(x)] += depth_[static_cast<std::size_t>(x)] < nowhere ? 1 : 0;
        });
      for (const std::uint32_t n : count_) {
        sum.most = std::max(sum.most, n);
        sum.fragments += n;
        sum.beyond += n > limit ? n - limit : 0;
      }
    }
    return sum;
  }

 private:
  static constexpr int size = TriangleBins::size, chunk = 16;
  static constexpr int stride =
      size + 1;  // of a row of pixels: what ends at the right rim is noted behind it
  static constexpr R nowhere = std::numeric_limits<R>::infinity();

  std::size_t place(int sample, int x, int y) const {
    return static_cast<std::size_t>(((sample - first_) * size + y - corner_.y) * stride + x - corner_.x);
  }

  // Calls body(triangle, its box, number of the entry) for those that hide, or for all.
  void for_triangles(bool hiding, const auto& body) const {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const BinEntry& e = entries_[i];
      const PixelRect box = box_in(part_, corner_, e);
      if (box.empty() || (hiding && !scene_.hides_at(e.face))) continue;
      body(*screen_triangle(scene_.fill.mesh, e.face, scene_.fill.sign()), box,
           static_cast<std::uint32_t>(i));
    }
  }
  // Calls body(y, span) for the rows of a box that a triangle covers at a sample that all pixels have at one place.
  void for_spans(const ScreenTriangle<R>& t, const PixelRect& box, int sample, const auto& body) const {
    RowSpans spans(t.edge, pattern_.x[static_cast<std::size_t>(sample)],
                   pattern_.y[static_cast<std::size_t>(sample)], box);
    for (int y = box.y0; y < box.y1; ++y)
      if (const PixelSpan span = spans.next(); !span.empty()) body(y, span);
  }
  // Calls body(place of the first pixel, pixels, number of the entry) for each row of each triangle, its depths in
  // depth_: infinite where it is not.
  void for_depths(bool hiding, const auto& body) {
    for_triangles(hiding, [&](const ScreenTriangle<R>& t, const PixelRect& box, std::uint32_t i) {
      for (int s = first_; s < end_; ++s) {
        if (pattern_.period == 1) {
          for_spans(t, box, s, [&](int y, PixelSpan span) {
            const auto sample = static_cast<std::size_t>(s);
            Rows::depths(RowDepths<R>(t.depth, 0, y, pattern_.x[sample], pattern_.y[sample]), span,
                         depth_.data());
            body(place(s, span.x0, y), span.x1 - span.x0, i);
          });
          continue;
        }
        for (int y = box.y0; y < box.y1; ++y)
          if (varying_depths(t, pattern_, s, y, box, depth_.data()))
            body(place(s, box.x0, y), box.x1 - box.x0, i);
      }
    });
  }

  // Notes where spans begin and end, and sums that up: no work a pixel and triangle.
  void count_spans() {
    for_triangles(false, [&](const ScreenTriangle<R>& t, const PixelRect& box, std::uint32_t) {
      for (int s = first_; s < end_; ++s)
        for_spans(t, box, s, [&](int y, PixelSpan span) {
          ++count_[place(s, span.x0, y)];
          --count_[place(s, span.x1, y)];
        });
    });
    for (std::size_t row = 0; row < count_.size(); row += stride)
      for (std::size_t x = 1; x < stride; ++x) count_[row + x] += count_[row + x - 1];
  }

  // The nearest face that hides at each sample, then what is in front of it or as near and drawn no later.
  void count_before_cuts() {
    std::fill(cut_.begin(), cut_.end(), nowhere);
    for_depths(true, [&](std::size_t at, int n, std::uint32_t i) {
      for (std::size_t x = 0; x < static_cast<std::size_t>(n); ++x)
        if (depth_[x] < cut_[at + x]) cut_[at + x] = depth_[x], rank_[at + x] = i;
    });
    for_depths(false, [&](std::size_t at, int n, std::uint32_t i) {
      for (std::size_t x = 0; x < static_cast<std::size_t>(n); ++x) {
        const R z = depth_[x], cut = cut_[at + x];
        count_[at + x] += z < cut || (z == cut && i <= rank_[at + x] && z < nowhere) ? 1 : 0;
      }
    });
  }

  const FragmentScene<R>& scene_;
  const SamplePositions& pattern_;
  const std::span<const BinEntry> entries_;
  const glm::ivec2 corner_;
  const PixelRect part_;
  std::vector<std::uint32_t> count_, rank_;
  std::vector<R> cut_, depth_;
  int first_ = 0, end_ = 0;  // samples that are counted now
};

}  // namespace detail

// Counts the fragments of one bin, as fill_fragments leaves them where there are layers enough; `limit` is that of
// FragmentCounts::beyond. Cost: O(rows of the entries' boxes * samples), times their pixels where a face hides or the
// pattern varies from pixel to pixel.
template <std::floating_point R, class Rows = FragmentRows>
FragmentCounts count_fragments(const FragmentScene<R>& scene, int column, int row, std::uint32_t limit) {
  return detail::FragmentCounter<R, Rows>(scene, column, row).count(limit);
}

}  // namespace frustum::kernels
