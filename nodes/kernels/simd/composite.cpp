#include "nodes/kernels/simd/composite.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/composite.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR
namespace hn = hwy::HWY_NAMESPACE;

bool put_behind(const float* red, const float* green, const float* blue, const float* alpha,
                const CompositeSums& to) {
  bool shines = false;
  const auto put = [&](auto d, std::size_t x) {
    const hn::Rebind<float, decltype(d)> df;
    const auto one = hn::Set(d, 1.0), through = hn::LoadU(d, to.through + x);
    const auto add = [&](const float* from, double* sum) {
      const auto value = hn::PromoteTo(d, hn::LoadU(df, from + x));
      hn::StoreU(hn::Add(hn::LoadU(d, sum + x), hn::Mul(through, value)), d, sum + x);
      return value;
    };
    add(red, to.red);
    add(green, to.green);
    add(blue, to.blue);
    const auto left = hn::Mul(through, hn::Sub(one, add(alpha, to.alpha)));
    hn::StoreU(left, d, to.through + x);
    shines = shines || !hn::AllFalse(d, hn::Gt(left, hn::Zero(d)));
  };
  const hn::ScalableTag<double> full;
  const std::size_t lanes = hn::Lanes(full);
  std::size_t x = 0;
  for (; x + lanes <= to.n; x += lanes) put(full, x);
  for (; x < to.n; ++x) put(hn::CappedTag<double, 1>(), x);
  return shines;
}

#else  // without vectors the twin itself

bool put_behind(const float* red, const float* green, const float* blue, const float* alpha,
                const CompositeSums& to) {
  return kernels::put_behind<float>(red, green, blue, alpha, to);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(put_behind);

bool put_behind(const float* red, const float* green, const float* blue, const float* alpha,
                const CompositeSums& to) {
  return HWY_DYNAMIC_DISPATCH(put_behind)(red, green, blue, alpha, to);
}

}  // namespace frustum::kernels::simd
#endif
