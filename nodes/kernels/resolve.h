// Samples of a supersampled picture weighted into pixels. The truth for every Real; simd/resolve.cpp has the
// twin for float, operation by operation.
#pragma once

#include "nodes/kernels/filter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace frustum::kernels {

/// The weights of a separable filter at the samples around a pixel's centre. The sample s of the pixel (x +
/// dx, y + dy) weighs wx wy, which depend on where the pattern puts it: on (x + dx, y + dy) modulo the
/// period.
template <std::floating_point R>
class ResolveWeights {
 public:
  static constexpr std::size_t padding = 15;  ///< elements that a vector of 16 may read past the last

  /// Offsets in 2^-12 px, [sample][y mod period][x mod period]; the period is a power of two.
  ResolveWeights(const Filter& filter, int samples, int period, std::span<const std::uint16_t> x,
                 std::span<const std::uint16_t> y)
      : margin_(margin_of(filter)), samples_(samples), period_(period) {
    const FilterCurve<R> curve(filter);
    fill(curve, x, across_, has_across_);
    fill(curve, y, down_, has_down_);
  }

  /// What an object of these numbers holds.
  static std::uint64_t bytes(const Filter& filter, int samples, int period) {
    const auto rows =
        static_cast<std::uint64_t>(2 * margin_of(filter) + 1) * static_cast<std::uint64_t>(samples);
    return 2 * sizeof(R) * rows * static_cast<std::uint64_t>(period) *
           (static_cast<std::uint64_t>(period) + padding);
  }

  /// Pixels to either side that the filter may touch: d + offset - 1/2 lies in [-radius, radius) for an
  /// offset in [0, 1) only where |d| < radius + 1/2.
  int margin() const { return margin_; }
  int samples() const { return samples_; }
  int period() const { return period_; }
  /// Whether any sample s of column dx, of row dy, has a weight.
  bool has_across(int dx, int s) const {
    return has_across_[static_cast<std::size_t>((dx + margin_) * samples_ + s)];
  }
  bool has_down(int dy, int s) const {
    return has_down_[static_cast<std::size_t>((dy + margin_) * samples_ + s)];
  }
  /// Weights wx of the samples s of pixels (x, y), (x + 1, y), ... in column dx; at least 16 of them.
  const R* across(int dx, int s, int x, int y) const { return at(across_, dx, s, x, y); }
  const R* down(int dy, int s, int x, int y) const { return at(down_, dy, s, x, y); }

 private:
  static constexpr std::size_t offsets = 4096;  // that a sample can have within its pixel, a side

  static int margin_of(const Filter& filter) { return static_cast<int>(std::ceil(filter.radius + 0.5)) - 1; }

  std::size_t row() const { return static_cast<std::size_t>(period_) + padding; }

  const R* at(const std::vector<R>& table, int d, int s, int x, int y) const {
    const auto u = static_cast<std::size_t>(x & (period_ - 1)),
               v = static_cast<std::size_t>(y & (period_ - 1));
    const auto block =
        static_cast<std::size_t>((d + margin_) * samples_ + s) * static_cast<std::size_t>(period_);
    return table.data() + (block + v) * row() + u;
  }

  void fill(const FilterCurve<R>& curve, std::span<const std::uint16_t> offset, std::vector<R>& table,
            std::vector<bool>& any) const {
    std::vector<R> at(offsets);
    table.reserve(static_cast<std::size_t>((2 * margin_ + 1) * samples_ * period_) * row());
    for (int d = -margin_; d <= margin_; ++d) {
      for (std::size_t i = 0; i < offsets; ++i)
        at[i] = curve(static_cast<R>(d) + static_cast<R>(i) * R(0x1p-12) - R(0.5));
      for (int s = 0; s < samples_; ++s) {
        bool found = false;
        for (int v = 0; v < period_; ++v)
          for (std::size_t u = 0; u < row(); ++u) {
            const auto column = u & static_cast<std::size_t>(period_ - 1);
            const auto i =
                static_cast<std::size_t>(s * period_ + v) * static_cast<std::size_t>(period_) + column;
            table.push_back(at[offset[i]]);
            found = found || table.back() != R(0);
          }
        any.push_back(found);
      }
    }
  }

  int margin_, samples_, period_;
  std::vector<R> across_, down_;
  std::vector<bool> has_across_, has_down_;
};

/// A row of pixels (x0, y) ... (x0 + n - 1, y) to be made, and what it reads.
template <std::floating_point R>
struct ResolveRow {
  int x0 = 0, y = 0;
  std::size_t n = 0;
  int left = 0, right = 0;                           ///< columns of the window from x0: left <= 0, right >= n
  int top = 0, bottom = 0;                           ///< rows of the window from y: top <= 0, bottom > 0
  std::span<const R* const> in;                      ///< by plane: sample 0 of pixel (x0, y)
  std::ptrdiff_t sample_stride = 0, row_stride = 0;  ///< elements
  std::span<const std::uint32_t* const>
      flat;                 ///< by plane: not 0 where all samples in reach have the same bits
  std::span<R* const> out;  ///< by plane

  const R* samples(std::size_t plane, int sample, int dy) const {
    return in[plane] + sample * sample_stride + dy * row_stride;
  }
};

/// Pixel x of every plane: sum(w c) / sum(w) over the samples in the window, in the order dy, s, dx. Where
/// all samples in reach have the same bits, these bits. Where no sample has a weight, the pixel's first
/// sample.
template <std::floating_point R>
void resolve_pixel(const ResolveWeights<R>& weights, const ResolveRow<R>& row, std::size_t x) {
  const int m = weights.margin(), px = static_cast<int>(x);
  for (std::size_t p = 0; p < row.out.size(); ++p) {
    row.out[p][x] = row.in[p][px];
    if (row.flat[p][x] != 0) continue;
    R sum = 0, total = 0;
    for (int dy = std::max(-m, row.top); dy <= m && dy < row.bottom; ++dy)
      for (int s = 0; s < weights.samples(); ++s) {
        if (!weights.has_down(dy, s)) continue;
        const R* c = row.samples(p, s, dy);
        for (int dx = std::max(-m, row.left - px); dx <= m && px + dx < row.right; ++dx) {
          if (!weights.has_across(dx, s)) continue;
          const int sx = row.x0 + px + dx, sy = row.y + dy;
          const R w = *weights.across(dx, s, sx, sy) * *weights.down(dy, s, sx, sy);
          total = total + w;
          sum = sum + w * c[px + dx];
        }
      }
    if (total != R(0)) row.out[p][x] = sum / total;
  }
}

template <std::floating_point R>
void resolve_row(const ResolveWeights<R>& weights, const ResolveRow<R>& row) {
  for (std::size_t x = 0; x < row.n; ++x) resolve_pixel(weights, row, x);
}

// ----- where nothing is to be filtered

template <std::floating_point R>
using BitsOf = std::conditional_t<sizeof(R) == 4, std::uint32_t, std::uint64_t>;

/// For each of n pixels ~0 where its samples, `stride` elements apart, have the same bits, else 0; and the
/// bits of the first one.
template <std::floating_point R>
void find_equal_samples(const R* first, int samples, std::ptrdiff_t stride, std::size_t n,
                        std::uint32_t* equal, BitsOf<R>* bits) {
  for (std::size_t x = 0; x < n; ++x) {
    bits[x] = std::bit_cast<BitsOf<R>>(first[x]);
    bool same = true;
    for (int s = 1; s < samples; ++s)
      same = same && std::bit_cast<BitsOf<R>>((first + s * stride)[x]) == bits[x];
    equal[x] = same ? ~0u : 0u;
  }
}

/// For each of n pixels ~0 where `equal` holds and `bits` agree for it and its neighbours at the given
/// distances in elements, else 0. Both arrays are readable at these distances.
template <class Bits>
void find_equal_neighbours(const std::uint32_t* equal, const Bits* bits,
                           std::span<const std::ptrdiff_t> distance, std::size_t n, std::uint32_t* out) {
  for (std::size_t x = 0; x < n; ++x) {
    std::uint32_t all = equal[x];
    for (const std::ptrdiff_t d : distance) {
      const auto at = static_cast<std::ptrdiff_t>(x) + d;
      all &= bits[at] == bits[x] ? equal[at] : 0u;
    }
    out[x] = all;
  }
}

}  // namespace frustum::kernels
