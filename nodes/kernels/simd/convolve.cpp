#include "nodes/kernels/simd/convolve.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/convolve.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A last, partial vector is made twice in part.
void weigh(std::span<const float* const> rows, std::span<const float> weight, std::size_t n, float* out) {
  const hn::ScalableTag<float> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const std::size_t lanes = hn::Lanes(d);
  if (n < lanes) return kernels::weigh_rows(rows, weight, n, out);
  for (std::size_t i = 0; i < n; i += lanes) {
    const std::size_t x = std::min(i, n - lanes);
    const auto first = hn::LoadU(d, rows[0] + x);
    auto differ = hn::Zero(du);
    auto sum = hn::Mul(hn::Set(d, weight[0]), first);
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const auto v = hn::LoadU(d, rows[k] + x);
      differ = hn::Or(differ, hn::Xor(hn::BitCast(du, v), hn::BitCast(du, first)));
      sum = hn::Add(sum, hn::Mul(hn::Set(d, weight[k]), v));
    }
    const auto same = hn::RebindMask(d, hn::Eq(differ, hn::Zero(du)));
    hn::StoreU(hn::IfThenElse(same, first, sum), d, out + x);
  }
}

}  // namespace
}  // namespace frustum::kernels::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(weigh);

void weigh_rows(std::span<const float* const> rows, std::span<const float> weight, std::size_t n,
                float* out) {
  HWY_DYNAMIC_DISPATCH(weigh)(rows, weight, n, out);
}

}  // namespace frustum::kernels::simd
#endif
