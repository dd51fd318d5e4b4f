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

// first, first + 1 ... A constant and a sum: Iota of a number that is not known yet is built in memory, lane by lane.
template <class Di>
HWY_INLINE hn::Vec<Di> numbers_from(Di di, int first) {
  return hn::Add(hn::Iota(di, 0), hn::Set(di, first));
}

template <class D>
HWY_INLINE hn::Vec<D> depths_from(D d, const RowDepths<float>& row, int x) {
  const hn::RebindToSigned<D> di;
  const auto across = hn::Add(hn::ConvertTo(d, numbers_from(di, row.first + x)), hn::Set(d, row.part));
  auto z = hn::Add(hn::Set(d, row.start), hn::Mul(hn::Set(d, row.dx), across));
  const auto least = hn::Set(d, row.least), greatest = hn::Set(d, row.greatest);
  z = hn::IfThenElse(hn::Lt(z, least), least, z);
  return hn::IfThenElse(hn::Gt(z, greatest), greatest, z);
}
template <class D>
HWY_INLINE hn::Vec<D> depths_from(D d, const float* row, int x) {
  return hn::LoadU(d, row + x);
}

// FragmentRows::insert at the pixels from x on, of which those in [span.x0, span.x1) count.
template <class D, class Depths>
HWY_INLINE void insert_vector(D d, const FragmentRow<float>& row, int x, PixelSpan span, const Depths& depths,
                              std::uint32_t face, bool hides) {
  const hn::RebindToUnsigned<D> du;
  const hn::RebindToSigned<D> di;
  const auto lane = numbers_from(di, x);
  const auto within = hn::And(hn::Gt(lane, hn::Set(di, span.x0 - 1)), hn::Lt(lane, hn::Set(di, span.x1)));
  const auto mine = depths_from(d, depths, x);
  const int last = row.layers - 1;
  float* z = row.z + x;
  std::uint32_t* id = row.id + x;
  auto on = hn::And(hn::RebindMask(d, within), hn::Lt(mine, hn::LoadU(d, z + last * row.z_stride)));
  if (row.cut != nullptr) on = hn::And(on, hn::Lt(mine, hn::LoadU(d, row.cut + x)));
  if (hn::AllFalse(d, on)) return;
  const auto on_u = hn::RebindMask(du, on);
  const auto before = hn::LoadU(du, row.count + x);
  const auto after = hn::IfThenElse(on_u, hn::Add(before, hn::Set(du, 1u)), before);
  hn::StoreU(hn::Min(after, hn::Set(du, static_cast<std::uint32_t>(row.layers))), du, row.count + x);
  if (hides) hn::StoreU(hn::IfThenElse(on, mine, hn::LoadU(d, row.cut + x)), d, row.cut + x);
  const std::uint32_t most = hn::GetLane(hn::MaxOfLanes(du, hn::IfThenElseZero(on_u, before)));
  int layer = std::min(static_cast<int>(most), last);
  z += layer * row.z_stride, id += layer * row.id_stride;
  const auto place = hn::Set(du, face);
  auto z_here = hn::LoadU(d, z);
  auto id_here = hn::LoadU(du, id);
  for (; layer > 0; --layer) {
    const auto z_front = hn::LoadU(d, z - row.z_stride);
    const auto id_front = hn::LoadU(du, id - row.id_stride);
    const auto further = hn::And(on, hn::Lt(mine, z_front));
    const auto further_u = hn::RebindMask(du, further);
    z_here = hn::IfThenElse(further, z_front, hn::IfThenElse(on, mine, z_here));
    id_here = hn::IfThenElse(further_u, id_front, hn::IfThenElse(hn::RebindMask(du, on), place, id_here));
    hn::StoreU(z_here, d, z);
    hn::StoreU(id_here, du, id);
    if (hn::AllFalse(d, further)) return;
    on = further, z_here = z_front, id_here = id_front;
    z -= row.z_stride, id -= row.id_stride;
  }
  hn::StoreU(hn::IfThenElse(on, mine, z_here), d, z);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(du, on), place, id_here), du, id);
}

// FragmentRows by vectors; the templates call these by name, so they are static members as there.
struct Rows {
  static void depths(const RowDepths<float>& depth, PixelSpan span, float* HWY_RESTRICT out) {
    each_vector(span.x1 - span.x0,
                [&](auto d, int i) { hn::StoreU(depths_from(d, depth, span.x0 + i), d, out + i); });
  }

  // Vectors stand at multiples of their length in the row, the last one shifted back to end with it: what lies beside
  // the span in the row keeps its bytes, and nothing outside the row is touched, which other threads may write.
  template <class Depths>
  static void insert(const FragmentRow<float>& row, PixelSpan span, const Depths& depths, std::uint32_t face,
                     bool hides) {
    const Full d;
    const int lanes = static_cast<int>(hn::Lanes(d));
    if (row.width < lanes) {
      for (int x = span.x0; x < span.x1; ++x)
        insert_vector(hn::CappedTag<float, 1>(), row, x, span, depths, face, hides);
      return;
    }
    for (int x = span.x0 / lanes * lanes; x < span.x1; x += lanes)
      insert_vector(d, row, std::min(x, row.width - lanes), {std::max(x, span.x0), span.x1}, depths, face,
                    hides);
  }

  static void finish(const float* HWY_RESTRICT cut, float sign, float far, int n,
                     std::uint32_t* HWY_RESTRICT id, float* HWY_RESTRICT z) {
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
