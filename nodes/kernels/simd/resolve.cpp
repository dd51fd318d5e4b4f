#include "nodes/kernels/simd/resolve.h"

#include <algorithm>
#include <array>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/resolve.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using Du = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;

// The weights that a row of pixels uses, found once: for each row and sample that counts, where its weights
// and those of its columns begin for the pattern's column 0.
struct Taps {
  struct Line {
    int dy, sample;
    const float* down;
  };
  std::vector<Line> lines;
  std::vector<const float*> across;  // [line][dx + margin], null where the column has no weight
  std::size_t columns = 0;

  void find(const ResolveWeights<float>& weights, const ResolveRow<float>& row) {
    const int m = weights.margin();
    columns = static_cast<std::size_t>(2 * m + 1);
    for (int dy = std::max(-m, row.top); dy <= m && dy < row.bottom; ++dy)
      for (int s = 0; s < weights.samples(); ++s) {
        if (!weights.has_down(dy, s)) continue;
        lines.push_back({dy, s, weights.down(dy, s, 0, row.y + dy)});
        for (int dx = -m; dx <= m; ++dx)
          across.push_back(weights.has_across(dx, s) ? weights.across(dx, s, 0, row.y + dy) : nullptr);
      }
  }
};

HWY_INLINE bool is_flat(const ResolveRow<float>& row, std::size_t x, std::size_t first, std::size_t planes) {
  const Du du;
  auto all = hn::LoadU(du, row.flat[first] + x);
  for (std::size_t p = 1; p < planes; ++p) all = hn::And(all, hn::LoadU(du, row.flat[first + p] + x));
  return hn::AllTrue(du, hn::Ne(all, hn::Zero(du)));
}

// The vector of pixels from x on, for the planes first ... first + planes - 1; no filter leaves the window
// sideways.
template <std::size_t planes>
HWY_INLINE void resolve_vector(const ResolveWeights<float>& weights, const ResolveRow<float>& row, Taps& taps,
                               std::size_t x, std::size_t first) {
  const D d;
  const Du du;
  if (is_flat(row, x, first, planes)) {
    for (std::size_t p = first; p < first + planes; ++p)
      hn::StoreU(hn::LoadU(d, row.in[p] + x), d, row.out[p] + x);
    return;
  }
  if (taps.lines.empty()) taps.find(weights, row);

  const int m = weights.margin(), px = static_cast<int>(x);
  std::array<std::size_t, 64> column;  // of the pattern, by dx + m; radii end at 16 and margins at 17
  for (int dx = -m; dx <= m; ++dx)
    column[static_cast<std::size_t>(dx + m)] =
        static_cast<std::size_t>((row.x0 + px + dx) & (weights.period() - 1));
  std::array<V, planes> sum;
  for (V& s : sum) s = hn::Zero(d);
  V total = hn::Zero(d);
  const float* const* across = taps.across.data();
  for (const Taps::Line& line : taps.lines) {
    std::array<const float*, planes> c;
    for (std::size_t p = 0; p < planes; ++p) c[p] = row.samples(first + p, line.sample, line.dy) + px - m;
    for (std::size_t i = 0; i < taps.columns; ++i) {
      const float* a = *across++;
      if (a == nullptr) continue;
      const V w = hn::Mul(hn::LoadU(d, a + column[i]), hn::LoadU(d, line.down + column[i]));
      total = hn::Add(total, w);
      for (std::size_t p = 0; p < planes; ++p) sum[p] = hn::Add(sum[p], hn::Mul(w, hn::LoadU(d, c[p] + i)));
    }
  }
  const auto weighted = hn::Ne(total, hn::Zero(d));
  for (std::size_t p = 0; p < planes; ++p) {
    const V own = hn::LoadU(d, row.in[first + p] + x);
    const auto flat = hn::RebindMask(d, hn::Ne(hn::LoadU(du, row.flat[first + p] + x), hn::Zero(du)));
    const V mean = hn::IfThenElse(weighted, hn::Div(sum[p], total), own);
    hn::StoreU(hn::IfThenElse(flat, own, mean), d, row.out[first + p] + x);
  }
}

HWY_INLINE void resolve_planes(const ResolveWeights<float>& weights, const ResolveRow<float>& row, Taps& taps,
                               std::size_t x) {
  std::size_t p = 0;
  for (; p + 4 <= row.out.size(); p += 4) resolve_vector<4>(weights, row, taps, x, p);
  for (; p < row.out.size(); ++p) resolve_vector<1>(weights, row, taps, x, p);
}

// Columns whose filter leaves the window are the scalar twin's; a last, partial vector is made twice in part.
void resolve(const ResolveWeights<float>& weights, const ResolveRow<float>& row) {
  const std::size_t lanes = hn::Lanes(D());
  const int m = weights.margin(), n = static_cast<int>(row.n);
  const auto begin = static_cast<std::size_t>(std::clamp(row.left + m, 0, n));
  const auto end = static_cast<std::size_t>(std::clamp(row.right - m, static_cast<int>(begin), n));
  if (end - begin < lanes) return kernels::resolve_row(weights, row);
  Taps taps;
  for (std::size_t x = 0; x < begin; ++x) kernels::resolve_pixel(weights, row, x);
  for (std::size_t x = begin; x < end; x += lanes)
    resolve_planes(weights, row, taps, std::min(x, end - lanes));
  for (std::size_t x = end; x < row.n; ++x) kernels::resolve_pixel(weights, row, x);
}

void equal_samples(const float* first, int samples, std::ptrdiff_t stride, std::size_t n,
                   std::uint32_t* equal, std::uint32_t* bits) {
  const D d;
  const Du du;
  const std::size_t lanes = hn::Lanes(d);
  if (n < lanes) return kernels::find_equal_samples(first, samples, stride, n, equal, bits);
  for (std::size_t i = 0; i < n; i += lanes) {
    const std::size_t x = std::min(i, n - lanes);
    const auto mine = hn::BitCast(du, hn::LoadU(d, first + x));
    auto differ = hn::Zero(du);
    for (int s = 1; s < samples; ++s)
      differ = hn::Or(differ, hn::Xor(mine, hn::BitCast(du, hn::LoadU(d, first + s * stride + x))));
    hn::StoreU(hn::VecFromMask(du, hn::Eq(differ, hn::Zero(du))), du, equal + x);
    hn::StoreU(mine, du, bits + x);
  }
}

void equal_neighbours(const std::uint32_t* equal, const std::uint32_t* bits,
                      std::span<const std::ptrdiff_t> distance, std::size_t n, std::uint32_t* out) {
  const Du du;
  const std::size_t lanes = hn::Lanes(du);
  if (n < lanes) return kernels::find_equal_neighbours(equal, bits, distance, n, out);
  for (std::size_t i = 0; i < n; i += lanes) {
    const std::size_t x = std::min(i, n - lanes);
    const auto mine = hn::LoadU(du, bits + x);
    auto all = hn::LoadU(du, equal + x);
    for (const std::ptrdiff_t step : distance) {
      const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x) + step;
      const auto same = hn::VecFromMask(du, hn::Eq(hn::LoadU(du, bits + at), mine));
      all = hn::And(all, hn::And(same, hn::LoadU(du, equal + at)));
    }
    hn::StoreU(all, du, out + x);
  }
}

}  // namespace
}  // namespace frustum::kernels::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(resolve);
HWY_EXPORT(equal_samples);
HWY_EXPORT(equal_neighbours);

void resolve_row(const ResolveWeights<float>& weights, const ResolveRow<float>& row) {
  HWY_DYNAMIC_DISPATCH(resolve)(weights, row);
}
void find_equal_samples(const float* first, int samples, std::ptrdiff_t stride, std::size_t n,
                        std::uint32_t* equal, std::uint32_t* bits) {
  HWY_DYNAMIC_DISPATCH(equal_samples)(first, samples, stride, n, equal, bits);
}
void find_equal_neighbours(const std::uint32_t* equal, const std::uint32_t* bits,
                           std::span<const std::ptrdiff_t> distance, std::size_t n, std::uint32_t* out) {
  HWY_DYNAMIC_DISPATCH(equal_neighbours)(equal, bits, distance, n, out);
}

}  // namespace frustum::kernels::simd
#endif
