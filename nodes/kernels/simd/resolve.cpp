#include "nodes/kernels/simd/resolve.h"

#include <algorithm>
#include <array>

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

// The vector of pixels from x on, for the planes first ... first + planes - 1, all in the inside of the
// window.
template <std::size_t planes>
HWY_INLINE void resolve_vector(const ResolveWeights<float>& weights, const ResolveRow<float>& row,
                               std::size_t x, std::size_t first) {
  const D d;
  const Du du;
  const int m = weights.margin(), samples = weights.samples(), px = static_cast<int>(x);
  const auto rows = static_cast<std::size_t>(2 * m + 1);
  const auto in = [&](std::size_t p, int s, int dy) {
    return row.in[((first + p) * static_cast<std::size_t>(samples) + static_cast<std::size_t>(s)) * rows +
                  static_cast<std::size_t>(dy + m)] +
           px;
  };
  auto all_flat = hn::LoadU(du, row.flat[first] + x);
  for (std::size_t p = 1; p < planes; ++p)
    all_flat = hn::And(all_flat, hn::LoadU(du, row.flat[first + p] + x));
  if (hn::AllTrue(du, hn::Ne(all_flat, hn::Zero(du)))) {
    for (std::size_t p = 0; p < planes; ++p) hn::StoreU(hn::LoadU(d, in(p, 0, 0)), d, row.out[first + p] + x);
    return;
  }

  std::array<V, planes> sum;
  for (V& s : sum) s = hn::Zero(d);
  V total = hn::Zero(d);
  for (int dy = -m; dy <= m; ++dy) {
    if (row.in[static_cast<std::size_t>(dy + m)] == nullptr) continue;
    for (int s = 0; s < samples; ++s) {
      if (!weights.has_down(dy, s)) continue;
      std::array<const float*, planes> c;
      for (std::size_t p = 0; p < planes; ++p) c[p] = in(p, s, dy);
      for (int dx = -m; dx <= m; ++dx) {
        if (!weights.has_across(dx, s)) continue;
        const int sx = row.x0 + px + dx, sy = row.y + dy;
        const V w =
            hn::Mul(hn::LoadU(d, weights.across(dx, s, sx, sy)), hn::LoadU(d, weights.down(dy, s, sx, sy)));
        total = hn::Add(total, w);
        for (std::size_t p = 0; p < planes; ++p)
          sum[p] = hn::Add(sum[p], hn::Mul(w, hn::LoadU(d, c[p] + dx)));
      }
    }
  }
  const auto weighted = hn::Ne(total, hn::Zero(d));
  for (std::size_t p = 0; p < planes; ++p) {
    const V own = hn::LoadU(d, in(p, 0, 0));
    const auto flat = hn::RebindMask(d, hn::Ne(hn::LoadU(du, row.flat[first + p] + x), hn::Zero(du)));
    const V mean = hn::IfThenElse(weighted, hn::Div(sum[p], total), own);
    hn::StoreU(hn::IfThenElse(flat, own, mean), d, row.out[first + p] + x);
  }
}

HWY_INLINE void resolve_planes(const ResolveWeights<float>& weights, const ResolveRow<float>& row,
                               std::size_t x) {
  std::size_t p = 0;
  for (; p + 4 <= row.out.size(); p += 4) resolve_vector<4>(weights, row, x, p);
  for (; p < row.out.size(); ++p) resolve_vector<1>(weights, row, x, p);
}

// Columns whose filter leaves the window are the scalar twin's; a last, partial vector is made twice in part.
void resolve(const ResolveWeights<float>& weights, const ResolveRow<float>& row) {
  const std::size_t lanes = hn::Lanes(D());
  const int m = weights.margin(), n = static_cast<int>(row.n);
  const auto begin = static_cast<std::size_t>(std::clamp(row.left + m, 0, n));
  const auto end = static_cast<std::size_t>(std::clamp(row.right - m, static_cast<int>(begin), n));
  if (end - begin < lanes) return kernels::resolve_row(weights, row);
  for (std::size_t x = 0; x < begin; ++x) kernels::resolve_pixel(weights, row, x);
  for (std::size_t x = begin; x < end; x += lanes) resolve_planes(weights, row, std::min(x, end - lanes));
  for (std::size_t x = end; x < row.n; ++x) kernels::resolve_pixel(weights, row, x);
}

void equal_samples(std::span<const float* const> sample, std::size_t n, std::uint32_t* equal,
                   std::uint32_t* bits) {
  const D d;
  const Du du;
  const std::size_t lanes = hn::Lanes(d);
  if (n < lanes) return kernels::find_equal_samples(sample, n, equal, bits);
  for (std::size_t i = 0; i < n; i += lanes) {
    const std::size_t x = std::min(i, n - lanes);
    const auto first = hn::BitCast(du, hn::LoadU(d, sample[0] + x));
    auto differ = hn::Zero(du);
    for (const float* row : sample)
      differ = hn::Or(differ, hn::Xor(first, hn::BitCast(du, hn::LoadU(d, row + x))));
    hn::StoreU(hn::VecFromMask(du, hn::Eq(differ, hn::Zero(du))), du, equal + x);
    hn::StoreU(first, du, bits + x);
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
void find_equal_samples(std::span<const float* const> sample, std::size_t n, std::uint32_t* equal,
                        std::uint32_t* bits) {
  HWY_DYNAMIC_DISPATCH(equal_samples)(sample, n, equal, bits);
}
void find_equal_neighbours(const std::uint32_t* equal, const std::uint32_t* bits,
                           std::span<const std::ptrdiff_t> distance, std::size_t n, std::uint32_t* out) {
  HWY_DYNAMIC_DISPATCH(equal_neighbours)(equal, bits, distance, n, out);
}

}  // namespace frustum::kernels::simd
#endif
