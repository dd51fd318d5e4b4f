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

namespace {

// Colours and what still comes through, at one vector of samples.
template <class D>
struct Sums {
  hn::Vec<D> red, green, blue, alpha, through;
};

// Adds a layer where light comes through; false where there is no such lane.
template <class D>
HWY_INLINE bool put_behind(D d, const LayerRows<float>& in, std::ptrdiff_t layer, std::size_t x,
                           Sums<D>& to) {
  const hn::Rebind<float, D> df;
  const auto open = hn::Gt(to.through, hn::Zero(d));
  if (hn::AllFalse(d, open)) return false;
  const auto add = [&](std::size_t c, hn::Vec<D>& sum) HWY_ATTR {
    const auto value = hn::PromoteTo(d, hn::LoadU(df, in.first[c] + layer * in.stride[c] + x));
    sum = hn::IfThenElse(open, hn::Add(sum, hn::Mul(to.through, value)), sum);
    return value;
  };
  add(0, to.red);
  add(1, to.green);
  add(2, to.blue);
  const auto alpha = add(3, to.alpha);
  to.through = hn::IfThenElse(open, hn::Mul(to.through, hn::Sub(hn::Set(d, 1.0), alpha)), to.through);
  return true;
}

// `vectors` at once: layers may lie as far apart as makes their lines of cache push one another out, so each is read
// whole.
template <int vectors, class D>
HWY_INLINE void composite_at(D d, const LayerRows<float>& in, std::size_t x,
                             const std::array<float*, 4>& out) {
  const hn::Rebind<float, D> df;
  const std::size_t lanes = hn::Lanes(d);
  const auto zero = hn::Zero(d);
  Sums<D> sums[vectors];
  for (auto& s : sums) s = {zero, zero, zero, zero, hn::Set(d, 1.0)};
  for (std::ptrdiff_t layer = 0; layer < in.layers; ++layer) {
    bool any = false;
    for (std::size_t v = 0; v < vectors; ++v) any |= put_behind(d, in, layer, x + v * lanes, sums[v]);
    if (!any) break;
  }
  for (std::size_t v = 0; v < vectors; ++v) {
    const hn::Vec<D> sum[4] = {sums[v].red, sums[v].green, sums[v].blue, sums[v].alpha};
    for (std::size_t c = 0; c < 4; ++c)
      if (out[c] != nullptr) hn::StoreU(hn::DemoteTo(df, sum[c]), df, out[c] + x + v * lanes);
  }
}

}  // namespace

void composite_layers(const LayerRows<float>& in, std::size_t n, const std::array<float*, 4>& out) {
  const hn::ScalableTag<double> full;
  const std::size_t lanes = hn::Lanes(full);
  std::size_t x = 0;
  for (; x + 2 * lanes <= n; x += 2 * lanes) composite_at<2>(full, in, x, out);
  for (; x + lanes <= n; x += lanes) composite_at<1>(full, in, x, out);
  for (; x < n; ++x) composite_at<1>(hn::CappedTag<double, 1>(), in, x, out);
}

#else  // without vectors the twin itself

void composite_layers(const LayerRows<float>& in, std::size_t n, const std::array<float*, 4>& out) {
  kernels::composite_layers<float>(in, n, out);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(composite_layers);

void composite_layers(const LayerRows<float>& in, std::size_t n, const std::array<float*, 4>& out) {
  HWY_DYNAMIC_DISPATCH(composite_layers)(in, n, out);
}

}  // namespace frustum::kernels::simd
#endif
