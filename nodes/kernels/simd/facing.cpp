#include "nodes/kernels/simd/facing.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/facing.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <limits>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;

#if HWY_TARGET != HWY_SCALAR

struct Row {
  V x, y, w;
};

HWY_INLINE Row load_row(const RowLayout& rows, hn::Vec<hn::RebindToSigned<D>> vertex) {
  const D d;
  const hn::RebindToSigned<D> di;
  const auto at = hn::Mul(vertex, hn::Set(di, static_cast<std::int32_t>(rows.stride)));
  const auto component = [&](int k) HWY_ATTR { return hn::GatherIndex(d, rows.position + k, at); };
  return {component(0), component(1), rows.third < 0 ? hn::Set(d, 1.0F) : component(rows.third)};
}

HWY_INLINE Row edge(const Row& from, const Row& to) {
  return {hn::Sub(to.x, from.x), hn::Sub(to.y, from.y), hn::Sub(to.w, from.w)};
}

// The sign of each lane as a float: 1, -1 or 2.
HWY_INLINE V signs_of(const Row& a, const Row& e, const Row& f) {
  const D d;
  const auto m0 = hn::Mul(e.y, f.w), m1 = hn::Mul(e.w, f.y);
  const auto m2 = hn::Mul(e.w, f.x), m3 = hn::Mul(e.x, f.w);
  const auto m4 = hn::Mul(e.x, f.y), m5 = hn::Mul(e.y, f.x);
  const auto det = hn::Add(hn::Add(hn::Mul(a.x, hn::Sub(m0, m1)), hn::Mul(a.y, hn::Sub(m2, m3))),
                           hn::Mul(a.w, hn::Sub(m4, m5)));
  const auto both = [](V p, V q) HWY_ATTR { return hn::Add(hn::Abs(p), hn::Abs(q)); };
  const auto size = hn::Add(hn::Add(hn::Mul(hn::Abs(a.x), both(m0, m1)), hn::Mul(hn::Abs(a.y), both(m2, m3))),
                            hn::Mul(hn::Abs(a.w), both(m4, m5)));
  // Each term goes through 7 roundings, two of them those of the edges; 12 u leaves room for those of
  // `size`, and 2^-90 for products that underflow.
  const auto bound = hn::Mul(size, hn::Set(d, 12 * 0x1p-24F));
  const auto clear = hn::And(hn::Gt(hn::Abs(det), bound), hn::Gt(size, hn::Set(d, 0x1p-90F)));
  return hn::IfThenElse(clear, hn::CopySign(hn::Set(d, 1.0F), det),
                        hn::Set(d, static_cast<float>(unclear_sign)));
}

void clear_signs(const RowLayout& rows, const std::uint32_t* HWY_RESTRICT triangle,
                 std::int8_t* HWY_RESTRICT sign, std::size_t n) {
  const D d;
  const hn::RebindToUnsigned<D> du;
  const hn::RebindToSigned<D> di;
  const hn::Rebind<std::int8_t, D> d8;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    hn::Vec<decltype(du)> ia, ib, ic;
    hn::LoadInterleaved3(du, triangle + 3 * i, ia, ib, ic);
    const Row a = load_row(rows, hn::BitCast(di, ia));
    const Row b = load_row(rows, hn::BitCast(di, ib)), c = load_row(rows, hn::BitCast(di, ic));
    const auto signs = signs_of(a, edge(a, b), edge(a, c));
    hn::StoreU(hn::DemoteTo(d8, hn::ConvertTo(di, signs)), d8, sign + i);
  }
  for (; i < n; ++i) sign[i] = unclear_sign;
}

#else

void clear_signs(const RowLayout&, const std::uint32_t*, std::int8_t* sign, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) sign[i] = unclear_sign;
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {
namespace {
HWY_EXPORT(clear_signs);
}

void clear_signs(const RowLayout& rows, std::span<const glm::uvec3> triangle, std::span<std::int8_t> sign) {
  static_assert(sizeof(glm::uvec3) == 3 * sizeof(std::uint32_t));
  // Gathers index with 32 bits.
  if (rows.vertices * rows.stride >= std::numeric_limits<std::int32_t>::max()) {
    for (auto& s : sign) s = unclear_sign;
    return;
  }
  HWY_DYNAMIC_DISPATCH(clear_signs)
  (rows, reinterpret_cast<const std::uint32_t*>(triangle.data()), sign.data(), sign.size());
}
}  // namespace frustum::kernels::simd
#endif
