// Texels of one level of a pyramid, blended by area for a vector of points. Compiled once for each SIMD target.
#if defined(FRUSTUM_TEXELS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FRUSTUM_TEXELS_INL
#undef FRUSTUM_TEXELS_INL
#else
#define FRUSTUM_TEXELS_INL
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using Di = hn::RebindToSigned<D>;
using V = hn::Vec<D>;
using Vi = hn::Vec<Di>;
using M = hn::Mask<D>;
constexpr std::size_t max_lanes = HWY_MAX_BYTES / sizeof(float);

// A fraction f as `between` uses it: how far from the nearer end, at most 1/2; negative, -0 too, where that is the
// second.
HWY_INLINE V from_nearer(V f) {
  const D d;
  const V past = hn::Neg(hn::Sub(hn::Set(d, 1.0F), f));
  return hn::IfThenElse(hn::Gt(f, hn::Set(d, 0.5F)), past, f);
}

HWY_INLINE M is_second_nearer(V from_nearer) {
  const Di di;
  return hn::RebindMask(D(), hn::Lt(hn::BitCast(di, from_nearer), hn::Zero(di)));
}

// Where one level is read, lane by lane: the first texel of the nearer row and of the other one, how far off the
// second of either is, and how far from the nearer row and from the nearer column.
struct Taps {
  HWY_ALIGN std::int64_t row[2][max_lanes];  // addresses
  HWY_ALIGN std::int32_t step[max_lanes];    // in numbers, not texels
  bool adjacent;                             // the second texels follow the first ones in every lane
  V fx, fy;                                  // as from_nearer gives them; fy without its sign
};

// Numbers of textures are float, or std::uint16_t that hold binary16.
template <class T>
HWY_INLINE const T* texel_at(std::int64_t address) {
  return reinterpret_cast<const T*>(address);
}

template <class Df>
HWY_INLINE hn::Vec<Df> load(Df d, const float* from) {
  return hn::LoadU(d, from);
}
template <class Df>
HWY_INLINE hn::Vec<Df> load(Df d, const std::uint16_t* from) {
  const hn::Rebind<std::uint16_t, Df> d_bits;
  const hn::Rebind<hwy::float16_t, Df> d_half;
  return hn::PromoteTo(d, hn::BitCast(d_half, hn::LoadU(d_bits, from)));
}

// The addresses of the numbers that stand `offset` after `from`.
template <class T>
HWY_INLINE void find_rows(const T* from, Vi offset, std::int64_t* to) {
  const hn::RepartitionToWide<Di> dw;
  const auto at = hn::Set(dw, reinterpret_cast<std::int64_t>(from));
  const auto half = [&](auto part, std::int64_t* address) HWY_ATTR {
    hn::Store(hn::Add(at, hn::ShiftLeft<sizeof(T) / 2>(hn::PromoteTo(dw, part))), dw, address);
  };
  half(hn::LowerHalf(offset), to);
  half(hn::UpperHalf(hn::Half<Di>(), offset), to + hn::Lanes(dw));
}

// Colours stand in vectors as they do in memory, four numbers a point: vector `g` of a group holds the points
// from g * blocks on.
using D4 = hn::CappedTag<float, 4>;
HWY_INLINE std::size_t blocks() { return hn::Lanes(D()) / 4; }

// Neighbours in a row, each two for one point, as one load finds them: with vectors of 64 bytes those of points 0 and
// 2 of a group, and of 1 and 3; with 32 bytes of point 0, and of 1; with 16 bytes the first of the two, and the
// second.
struct Pairs {
  V part[2];
};

// The numbers that the lanes have for the points of the pairs of group `g`.
HWY_INLINE V spread_to_pairs(V of, std::size_t g, std::size_t part) {
  const Di di;
  const auto first = static_cast<std::int32_t>(blocks() * g);
  if (blocks() == 1) return hn::TableLookupLanes(of, hn::IndicesFromVec(D(), hn::Set(di, first)));
  const Vi two = hn::ShiftLeft<1>(hn::ShiftRight<3>(hn::Iota(di, 0)));
  const Vi point = hn::Add(two, hn::Set(di, first + static_cast<std::int32_t>(part)));
  return hn::TableLookupLanes(of, hn::IndicesFromVec(D(), point));
}

// Pairs from the addresses of their first texels; their first ones and their second ones; and texels one a block.
#if HWY_MAX_BYTES >= 64
template <class T>
HWY_INLINE V load_blocks(const T* const (&from)[max_lanes / 4]) {
  const hn::Half<D> dh;
  const D4 d4;
  return hn::Combine(D(), hn::Combine(dh, load(d4, from[3]), load(d4, from[2])),
                     hn::Combine(dh, load(d4, from[1]), load(d4, from[0])));
}
template <class T>
HWY_INLINE Pairs load_pairs(const std::int64_t* from) {
  const D d;
  const hn::Half<D> dh;
  return {{hn::Combine(d, load(dh, texel_at<T>(from[2])), load(dh, texel_at<T>(from[0]))),
           hn::Combine(d, load(dh, texel_at<T>(from[3])), load(dh, texel_at<T>(from[1])))}};
}
HWY_INLINE V first_of(const Pairs& p) {
  return hn::OddEvenBlocks(hn::SwapAdjacentBlocks(p.part[1]), p.part[0]);
}
HWY_INLINE V second_of(const Pairs& p) {
  return hn::OddEvenBlocks(p.part[1], hn::SwapAdjacentBlocks(p.part[0]));
}
#elif HWY_MAX_BYTES == 32
template <class T>
HWY_INLINE V load_blocks(const T* const (&from)[max_lanes / 4]) {
  const D4 d4;
  return hn::Combine(D(), load(d4, from[1]), load(d4, from[0]));
}
template <class T>
HWY_INLINE Pairs load_pairs(const std::int64_t* from) {
  const D d;
  return {{load(d, texel_at<T>(from[0])), load(d, texel_at<T>(from[1]))}};
}
HWY_INLINE V first_of(const Pairs& p) { return hn::ConcatLowerLower(D(), p.part[1], p.part[0]); }
HWY_INLINE V second_of(const Pairs& p) { return hn::ConcatUpperUpper(D(), p.part[1], p.part[0]); }
#else
template <class T>
HWY_INLINE V load_blocks(const T* const (&from)[max_lanes / 4]) {
  return load(D(), from[0]);
}
template <class T>
HWY_INLINE Pairs load_pairs(const std::int64_t* from) {
  const D d;
  return {{load(d, texel_at<T>(from[0])), load(d, texel_at<T>(from[0]) + 4)}};
}
HWY_INLINE V first_of(const Pairs& p) { return p.part[0]; }
HWY_INLINE V second_of(const Pairs& p) { return p.part[1]; }
#endif

// The four numbers of each point of vector `g` of a group get the number that lane has for the point.
HWY_INLINE V spread(V of, std::size_t g) {
  const Di di;
  const Vi first = hn::Set(di, static_cast<std::int32_t>(blocks() * g));
  const Vi point = hn::Add(hn::ShiftRight<2>(hn::Iota(di, 0)), first);
  return hn::TableLookupLanes(of, hn::IndicesFromVec(D(), point));
}

HWY_INLINE V towards(V nearer, V other, V share) {
  return hn::Add(nearer, hn::Mul(share, hn::Sub(other, nearer)));
}

// `between` in every lane, of a fraction that from_nearer has seen.
HWY_INLINE V blend(V a, V b, V f) {
  const M second = is_second_nearer(f);
  return towards(hn::IfThenElse(second, b, a), hn::IfThenElse(second, a, b), hn::Abs(f));
}

template <class T>
HWY_INLINE V fetch(const Taps& taps, std::size_t g) {
  const std::int64_t *nearer = taps.row[0] + g * blocks(), *other = taps.row[1] + g * blocks();
  V first, second;
  if (taps.adjacent) {
    Pairs down = load_pairs<T>(nearer);
    const Pairs beyond = load_pairs<T>(other);
    for (std::size_t i = 0; i < 2; ++i)
      down.part[i] = towards(down.part[i], beyond.part[i], spread_to_pairs(taps.fy, g, i));
    first = first_of(down), second = second_of(down);
  } else {
    const V fy = spread(taps.fy, g);
    const T* at[2][2][max_lanes / 4];  // by column and row
    for (std::size_t b = 0; b < blocks(); ++b) {
      at[0][0][b] = texel_at<T>(nearer[b]), at[0][1][b] = texel_at<T>(other[b]);
      const std::int32_t step = taps.step[g * blocks() + b];
      at[1][0][b] = at[0][0][b] + step, at[1][1][b] = at[0][1][b] + step;
    }
    first = towards(load_blocks(at[0][0]), load_blocks(at[0][1]), fy);
    second = towards(load_blocks(at[1][0]), load_blocks(at[1][1]), fy);
  }
  return blend(first, second, spread(taps.fx, g));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();
#endif

#endif
