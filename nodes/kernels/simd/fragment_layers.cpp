#include "nodes/kernels/simd/fragment_layers.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/fragment_layers.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Full = hn::ScalableTag<float>;

template <class F>
HWY_INLINE void each_vector(int n, F&& f) {
  const int lanes = static_cast<int>(hn::Lanes(Full()));
  int i = 0;
  for (; i + lanes <= n; i += lanes) f(Full(), i);
  for (; i + 4 <= n; i += 4) f(hn::CappedTag<float, 4>(), i);
  for (; i < n; ++i) f(hn::CappedTag<float, 1>(), i);
}

// FragmentRows by vectors; the templates call these by name, so they are static members as there.
struct Rows {
  template <class R>
  static void depths(const DepthPlane<R>& plane, int x, int y, int ox, int oy, int n, R* HWY_RESTRICT out) {
    using P = DepthPlane<R>;
    const float down = P::whole_px(y, plane.anchor.y) + P::fraction_px(oy, plane.anchor.y);
    const float start = plane.z + plane.dy * down, part = P::fraction_px(ox, plane.anchor.x);
    const int first = x - (plane.anchor.x >> corner_bits);
    each_vector(n, [&](auto d, int i) {
      const hn::RebindToSigned<decltype(d)> di;
      const auto across = hn::Add(hn::ConvertTo(d, hn::Iota(di, first + i)), hn::Set(d, part));
      auto z = hn::Add(hn::Set(d, start), hn::Mul(hn::Set(d, plane.dx), across));
      const auto least = hn::Set(d, plane.least), greatest = hn::Set(d, plane.greatest);
      z = hn::IfThenElse(hn::Lt(z, least), least, z);
      z = hn::IfThenElse(hn::Gt(z, greatest), greatest, z);
      hn::StoreU(z, d, out + i);
    });
  }

  template <class R>
  static std::uint32_t begin(const R* HWY_RESTRICT depth, const R* HWY_RESTRICT limit, std::uint32_t most,
                             int n, std::uint32_t* HWY_RESTRICT moving, std::uint32_t* HWY_RESTRICT count) {
    std::uint32_t top = 0;
    each_vector(n, [&](auto d, int i) {
      const hn::RebindToUnsigned<decltype(d)> du;
      const auto nearer = hn::Lt(hn::LoadU(d, depth + i), hn::LoadU(d, limit + i));
      const auto one = hn::IfThenElseZero(hn::RebindMask(du, nearer), hn::Set(du, 1u));
      const auto before = hn::LoadU(du, count + i);
      top = std::max(top, hn::GetLane(hn::MaxOfLanes(du, before)));
      hn::StoreU(one, du, moving + i);
      hn::StoreU(hn::Min(hn::Add(before, one), hn::Set(du, most)), du, count + i);
    });
    return top;
  }

  template <class R>
  static bool step(const R* HWY_RESTRICT depth, std::uint32_t face, int n, std::uint32_t* HWY_RESTRICT moving,
                   const std::uint32_t* HWY_RESTRICT id_front, const R* HWY_RESTRICT z_front,
                   std::uint32_t* HWY_RESTRICT id, R* HWY_RESTRICT z) {
    bool any = false;
    each_vector(n, [&](auto d, int i) {
      const hn::RebindToUnsigned<decltype(d)> du;
      const auto on = hn::Ne(hn::LoadU(du, moving + i), hn::Zero(du));
      const auto mine = hn::LoadU(d, depth + i), front = hn::LoadU(d, z_front + i);
      const auto further = hn::And(on, hn::RebindMask(du, hn::Lt(mine, front)));
      const auto on_f = hn::RebindMask(d, on), further_f = hn::RebindMask(d, further);
      hn::StoreU(hn::IfThenElse(further_f, front, hn::IfThenElse(on_f, mine, hn::LoadU(d, z + i))), d, z + i);
      hn::StoreU(hn::IfThenElse(further, hn::LoadU(du, id_front + i),
                                hn::IfThenElse(on, hn::Set(du, face), hn::LoadU(du, id + i))),
                 du, id + i);
      hn::StoreU(hn::IfThenElseZero(further, hn::Set(du, 1u)), du, moving + i);
      any = any || !hn::AllFalse(du, further);
    });
    return any;
  }

  template <class R>
  static void place(const R* HWY_RESTRICT depth, std::uint32_t face, int n,
                    const std::uint32_t* HWY_RESTRICT moving, std::uint32_t* HWY_RESTRICT id,
                    R* HWY_RESTRICT z) {
    each_vector(n, [&](auto d, int i) {
      const hn::RebindToUnsigned<decltype(d)> du;
      const auto on = hn::Ne(hn::LoadU(du, moving + i), hn::Zero(du));
      hn::StoreU(hn::IfThenElse(hn::RebindMask(d, on), hn::LoadU(d, depth + i), hn::LoadU(d, z + i)), d,
                 z + i);
      hn::StoreU(hn::IfThenElse(on, hn::Set(du, face), hn::LoadU(du, id + i)), du, id + i);
    });
  }

  template <class R>
  static void finish(const R* HWY_RESTRICT cut, float sign, float far, int n, std::uint32_t* HWY_RESTRICT id,
                     R* HWY_RESTRICT z) {
    each_vector(n, [&](auto d, int i) {
      const hn::RebindToUnsigned<decltype(d)> du;
      const auto depth = hn::LoadU(d, z + i);
      auto face = hn::LoadU(du, id + i);
      if (cut != nullptr) {
        const auto hidden = hn::RebindMask(du, hn::Gt(depth, hn::LoadU(d, cut + i)));
        face = hn::IfThenElse(hidden, hn::Set(du, no_face), face);
        hn::StoreU(face, du, id + i);
      }
      const auto empty = hn::RebindMask(d, hn::Eq(face, hn::Set(du, no_face)));
      hn::StoreU(hn::IfThenElse(empty, hn::Set(d, far), hn::Mul(hn::Set(d, sign), depth)), d, z + i);
    });
  }
};

}  // namespace

void fill_fragments(const FragmentScene<float>& scene, PixelRect rect, const FragmentLayers<float>& to,
                    const FragmentScratch<float>& scratch) {
  kernels::fill_fragments<float, Rows>(scene, rect, to, scratch);
}
FragmentCounts count_fragments(const FragmentScene<float>& scene, int column, int row, std::uint32_t limit) {
  return kernels::count_fragments<float, Rows>(scene, column, row, limit);
}

#else  // without vectors the twins themselves

void fill_fragments(const FragmentScene<float>& scene, PixelRect rect, const FragmentLayers<float>& to,
                    const FragmentScratch<float>& scratch) {
  kernels::fill_fragments<float>(scene, rect, to, scratch);
}
FragmentCounts count_fragments(const FragmentScene<float>& scene, int column, int row, std::uint32_t limit) {
  return kernels::count_fragments<float>(scene, column, row, limit);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(fill_fragments);
HWY_EXPORT(count_fragments);

void fill_fragments(const FragmentScene<float>& scene, PixelRect rect, const FragmentLayers<float>& to,
                    const FragmentScratch<float>& scratch) {
  HWY_DYNAMIC_DISPATCH(fill_fragments)(scene, rect, to, scratch);
}
FragmentCounts count_fragments(const FragmentScene<float>& scene, int column, int row, std::uint32_t limit) {
  return HWY_DYNAMIC_DISPATCH(count_fragments)(scene, column, row, limit);
}

}  // namespace frustum::kernels::simd
#endif
