#include "nodes/kernels/simd/transfer.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/transfer.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/elementary-inl.h"

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void convert(const ColorMap& map, float* r, float* g, float* b, std::size_t n) {
  kernels::convert_colors(map, r, g, b, n);
}

#else

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

HWY_INLINE V encode(const CurveIn<float>& k, V v) {
  const D d;
  const V a = hn::Abs(v);
  const V power = frustum::HWY_NAMESPACE::pow(d, a, hn::Set(d, k.power));
  const V rest = hn::Sub(hn::Mul(hn::Min(power, hn::Set(d, 1.0f)), hn::Set(d, k.rest)), hn::Set(d, k.offset));
  V curved = hn::Add(hn::Mul(power, hn::Set(d, k.scale)), rest);
  const V joint = hn::Set(d, k.knee * k.slope);
  curved = hn::IfThenElse(hn::Lt(curved, joint), joint, curved);
  return hn::CopySign(hn::IfThenElse(hn::Le(a, hn::Set(d, k.knee)), hn::Mul(a, hn::Set(d, k.slope)), curved),
                      v);
}

HWY_INLINE V decode(const CurveIn<float>& k, V v) {
  const D d;
  const V a = hn::Abs(v);
  const V base = hn::Div(hn::Add(a, hn::Set(d, k.offset)), hn::Set(d, k.scale));
  V curved = frustum::HWY_NAMESPACE::pow(d, base, hn::Set(d, k.power));
  const V joint = hn::Set(d, k.knee * k.slope);
  curved = hn::IfThenElse(hn::Lt(curved, joint), joint, curved);
  return hn::CopySign(hn::IfThenElse(hn::Le(a, hn::Set(d, k.knee)), hn::Mul(a, hn::Set(d, k.slope)), curved),
                      v);
}

HWY_INLINE V row(const float* m, V x, V y, V z) {
  const D d;
  const V xy = hn::Add(hn::Mul(hn::Set(d, m[0]), x), hn::Mul(hn::Set(d, m[1]), y));
  return hn::Add(xy, hn::Mul(hn::Set(d, m[2]), z));
}

HWY_INLINE V mixed(V x, V y, V z, float my, float mz) {
  const D d;
  return hn::Add(x, hn::Add(hn::Mul(hn::Set(d, my), hn::Sub(y, x)), hn::Mul(hn::Set(d, mz), hn::Sub(z, x))));
}

void convert(const ColorMap& map, float* r, float* g, float* b, std::size_t n) {
  const D d;
  const CurveIn<float> in = decoder<float>(map.from), out = encoder<float>(map.to);
  float m[9];
  for (std::size_t i = 0; i < 9; ++i) m[i] = static_cast<float>(map.matrix[i]);
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  for (; i + lanes <= n; i += lanes) {
    V x = hn::LoadU(d, r + i), y = hn::LoadU(d, g + i), z = hn::LoadU(d, b + i);
    if (map.from != Curve::linear) x = decode(in, x), y = decode(in, y), z = decode(in, z);
    if (map.keeps_grey) {
      const V u = mixed(x, y, z, m[1], m[2]), v = mixed(y, x, z, m[3], m[5]), w = mixed(z, x, y, m[6], m[7]);
      x = u, y = v, z = w;
    } else if (!map.same_primaries) {
      const V u = row(m, x, y, z), v = row(m + 3, x, y, z), w = row(m + 6, x, y, z);
      x = u, y = v, z = w;
    }
    if (map.to != Curve::linear) x = encode(out, x), y = encode(out, y), z = encode(out, z);
    hn::StoreU(x, d, r + i), hn::StoreU(y, d, g + i), hn::StoreU(z, d, b + i);
  }
  if (i < n) kernels::convert_colors(map, r + i, g + i, b + i, n - i);
}

#endif

}  // namespace
}  // namespace frustum::kernels::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(convert);

void convert_colors(const ColorMap& map, float* r, float* g, float* b, std::size_t n) {
  HWY_DYNAMIC_DISPATCH(convert)(map, r, g, b, n);
}

}  // namespace frustum::kernels::simd
#endif
