// The lesser and the greater of two, as the scalar twins write them. Compiled once for each SIMD target.
#if defined(FRUSTUM_ORDER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FRUSTUM_ORDER_INL
#undef FRUSTUM_ORDER_INL
#else
#define FRUSTUM_ORDER_INL
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#undef FRUSTUM_HAS_MINPS
#define FRUSTUM_HAS_MINPS (HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR)

// a < b ? a : b, for NaN and for zeros of two signs, too: what minps does, in one instruction instead of two.
template <class V>
HWY_INLINE V lesser(V a, V b) {
#if FRUSTUM_HAS_MINPS
  return hn::Min(a, b);
#else
  return hn::IfThenElse(hn::Lt(a, b), a, b);
#endif
}

// a > b ? a : b, likewise.
template <class V>
HWY_INLINE V greater(V a, V b) {
#if FRUSTUM_HAS_MINPS
  return hn::Max(a, b);
#else
  return hn::IfThenElse(hn::Gt(a, b), a, b);
#endif
}

// v < least ? least : v > greatest ? greatest : v, one after the other; NaN stays NaN.
template <class V>
HWY_INLINE V held_between(V v, V least, V greatest) {
  return lesser(greatest, greater(least, v));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#endif
