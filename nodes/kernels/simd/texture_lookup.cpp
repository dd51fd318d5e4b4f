#include "nodes/kernels/simd/texture_lookup.h"

#include <hwy/cache_control.h>

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/texture_lookup.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/texels-inl.h"

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

void look_up_pyramid(const TexelPyramid& p, const Filtering& filter, const UvRows<float>& in, std::size_t n,
                     const RgbaRows<float>& out) {
  kernels::look_up(p, filter, in, n, out);
}
void look_up_checker(const CheckerColors<float>& c, const Filtering& filter, const UvRows<float>& in,
                     std::size_t n, const RgbaRows<float>& out) {
  kernels::look_up(c, filter, in, n, out);
}

#else

UvRows<float> advanced(const UvRows<float>& r, std::size_t x) {
  const auto at = [x](auto* p) { return p == nullptr ? p : p + x; };
  return {at(r.u), at(r.v), at(r.du_dx), at(r.dv_dx), at(r.du_dy), at(r.dv_dy), at(r.id)};
}

RgbaRows<float> advanced(const RgbaRows<float>& r, std::size_t x) {
  RgbaRows<float> moved;
  for (std::size_t k = 0; k < 4; ++k) moved.plane[k] = r.plane[k] == nullptr ? nullptr : r.plane[k] + x;
  return moved;
}

// Calls body(in, out) for each whole vector of points. The last, partial one is left to the scalar twin of
// `source`.
template <class Source, class Body>
HWY_INLINE void for_each_vector(const Source& source, const Filtering& filter, const UvRows<float>& in,
                                std::size_t n, const RgbaRows<float>& out, Body&& body) {
  const std::size_t lanes = hn::Lanes(D());
  std::size_t x = 0;
  for (; x + lanes <= n; x += lanes) body(advanced(in, x), advanced(out, x));
  if (x < n) kernels::look_up(source, filter, advanced(in, x), n - x, advanced(out, x));
}

HWY_INLINE M covered(const UvRows<float>& in) {
  const D d;
  const hn::RebindToUnsigned<D> du;
  if (in.id == nullptr) return hn::Eq(hn::Zero(d), hn::Zero(d));
  return hn::RebindMask(d, hn::Ne(hn::LoadU(du, in.id), hn::Set(du, no_point)));
}

HWY_INLINE void put(const RgbaRows<float>& out, std::size_t k, M inside, V value) {
  const D d;
  if (out.plane[k] != nullptr) hn::StoreU(hn::IfThenElseZero(inside, value), d, out.plane[k]);
}

// ----- checkerboard

HWY_INLINE V square_wave(V x) {
  const D d;
  const V half = hn::Mul(x, hn::Set(d, 0.5F));
  const M odd = hn::Ge(hn::Sub(half, hn::Floor(half)), hn::Set(d, 0.5F));
  return hn::IfThenElse(odd, hn::Set(d, -1.0F), hn::Set(d, 1.0F));
}

HWY_INLINE V triangle_wave(V x) {
  const D d;
  const V positive = hn::Abs(x), two = hn::Set(d, 2.0F);
  const V r = hn::Sub(positive, hn::Mul(two, hn::Floor(hn::Mul(positive, hn::Set(d, 0.5F)))));
  return hn::IfThenElse(hn::Le(r, hn::Set(d, 1.0F)), r, hn::Sub(two, r));
}

HWY_INLINE V square_wave_mean(V x, V half) {
  const D d;
  const V a = hn::Sub(x, half), b = hn::Add(x, half);
  const V mean = hn::Div(hn::Sub(triangle_wave(b), triangle_wave(a)), hn::Sub(b, a));
  const V filtered = hn::IfThenElseZero(hn::And(hn::Lt(a, b), hn::Eq(mean, mean)), mean);
  return hn::IfThenElse(hn::Eq(a, b), square_wave(x), filtered);
}

void look_up_checker(const CheckerColors<float>& c, const Filtering& filter, const UvRows<float>& in,
                     std::size_t n, const RgbaRows<float>& out) {
  const D d;
  const V scale = hn::Set(d, c.scale), half_scale = hn::Set(d, 0.5F * c.scale), half = hn::Set(d, 0.5F);
  for_each_vector(c, filter, in, n, out, [&](const UvRows<float>& p, const RgbaRows<float>& rgba) HWY_ATTR {
    const M inside = covered(p);
    if (hn::AllFalse(d, inside)) {
      for (std::size_t k = 0; k < 4; ++k) put(rgba, k, inside, hn::Zero(d));
      return;
    }
    const V u = hn::Mul(hn::LoadU(d, p.u), scale), v = hn::Mul(hn::LoadU(d, p.v), scale);
    V mean_u, mean_v;
    if (filter.kind == Lookup::nearest) {
      mean_u = square_wave(u), mean_v = square_wave(v);
    } else {
      const V width_u = hn::Add(hn::Abs(hn::LoadU(d, p.du_dx)), hn::Abs(hn::LoadU(d, p.du_dy)));
      const V width_v = hn::Add(hn::Abs(hn::LoadU(d, p.dv_dx)), hn::Abs(hn::LoadU(d, p.dv_dy)));
      mean_u = square_wave_mean(u, hn::Mul(width_u, half_scale));
      mean_v = square_wave_mean(v, hn::Mul(width_v, half_scale));
    }
    const V e = hn::Add(half, hn::Mul(half, hn::Mul(mean_u, mean_v)));
    const V o = hn::Sub(hn::Set(d, 1.0F), e);
    for (std::size_t k = 0; k < 3; ++k)
      put(rgba, k, inside, hn::Add(hn::Mul(e, hn::Set(d, c.even[k])), hn::Mul(o, hn::Set(d, c.odd[k]))));
    put(rgba, 3, inside, hn::Set(d, 1.0F));
  });
}

// ----- pyramid

HWY_INLINE V fold(V u, EdgeRule rule) {
  const D d;
  const V one = hn::Set(d, 1.0F), two = hn::Set(d, 2.0F);
  if (rule == EdgeRule::clamp)
    return hn::IfThenElseZero(hn::Gt(u, hn::Zero(d)), hn::IfThenElse(hn::Lt(u, one), u, one));
  V t;
  if (rule == EdgeRule::repeat) {
    t = hn::Sub(u, hn::Floor(u));
  } else {
    const V m = hn::Sub(u, hn::Mul(two, hn::Floor(hn::Mul(u, hn::Set(d, 0.5F)))));
    t = hn::IfThenElse(hn::Le(m, one), m, hn::Sub(two, m));
  }
  return hn::IfThenElseZero(hn::Ge(t, hn::Zero(d)), t);
}

struct Pair {
  Vi first, second;
  V fraction;
};

HWY_INLINE Pair texel_pair(V t, V size, EdgeRule rule) {
  const D d;
  const Di di;
  const V x = hn::Sub(hn::Mul(t, size), hn::Set(d, 0.5F));
  const V low = hn::Floor(x);
  const Vi i = hn::ConvertTo(di, low), one = hn::Set(di, 1), zero = hn::Zero(di);
  const Vi last = hn::Sub(hn::ConvertTo(di, size), one), next = hn::Add(i, one);
  const bool repeat = rule == EdgeRule::repeat;
  const Vi first = hn::IfThenElse(hn::Lt(i, zero), repeat ? last : zero, i);
  const Vi second = hn::IfThenElse(hn::Gt(next, last), repeat ? zero : last, next);
  return {first, second, hn::Sub(x, low)};
}

HWY_INLINE V log2_of_footprint(V x) {
  const D d;
  const Di di;
  const hn::RebindToUnsigned<D> du;
  const auto bits = hn::BitCast(du, x);
  const auto exponent = hn::And(hn::ShiftRight<23>(bits), hn::Set(du, 0xFFu));
  const V whole = hn::ConvertTo(d, hn::Sub(hn::BitCast(di, exponent), hn::Set(di, 127)));
  const auto significand = hn::Or(hn::And(bits, hn::Set(du, 0x7FFFFFu)), hn::Set(du, 0x3F800000u));
  const V one = hn::Set(d, 1.0F), t = hn::Sub(hn::BitCast(d, significand), one);
  V q = hn::Set(d, level_log2[4]);
  for (std::size_t i = 4; i-- > 0;) q = hn::Add(hn::Mul(q, t), hn::Set(d, level_log2[i]));
  return hn::Add(whole, hn::Mul(t, hn::Add(one, hn::Mul(hn::Sub(one, t), q))));
}

HWY_INLINE V pyramid_level(const UvRows<float>& p, const TexelLevel& base, int last) {
  const D d;
  const V w = hn::Set(d, static_cast<float>(base.width)), h = hn::Set(d, static_cast<float>(base.height));
  const V ux = hn::Mul(hn::LoadU(d, p.du_dx), w), vx = hn::Mul(hn::LoadU(d, p.dv_dx), h);
  const V uy = hn::Mul(hn::LoadU(d, p.du_dy), w), vy = hn::Mul(hn::LoadU(d, p.dv_dy), h);
  const V a = hn::Add(hn::Mul(ux, ux), hn::Mul(vx, vx)), b = hn::Add(hn::Mul(uy, uy), hn::Mul(vy, vy));
  const V larger = hn::IfThenElse(hn::Or(hn::Ne(a, a), hn::Gt(a, b)), a, b);
  const V level = hn::Mul(hn::Set(d, 0.5F), log2_of_footprint(larger)),
          top = hn::Set(d, static_cast<float>(last));
  return hn::IfThenElseZero(hn::Gt(level, hn::Zero(d)), hn::IfThenElse(hn::Lt(level, top), level, top));
}

constexpr float cached_bytes = 256 << 10;  // a quarter of a core's second cache

// What is read of the levels of a pyramid, level by level; one more than there are, which is the last again.
template <class T>
struct LevelTable {
  const T* rgba[33];
  HWY_ALIGN float width[33 + max_lanes] = {}, height[33 + max_lanes] = {};
  std::size_t count;

  explicit LevelTable(const TexelPyramid& p) : count(p.levels.size() + 1) {
    for (std::size_t i = 0; i < count; ++i) {
      const TexelLevel& level = p.levels[std::min(i, p.levels.size() - 1)];
      if constexpr (sizeof(T) == sizeof(float))
        rgba[i] = level.rgba;
      else
        rgba[i] = level.half_rgba;
      width[i] = static_cast<float>(level.width), height[i] = static_cast<float>(level.height);
    }
  }

  // Gathering costs several times as much as picking from two vectors, which hold the levels of most pyramids.
  HWY_INLINE V pick(const float* of, Vi level) const {
    const D d;
    const Di di;
    const auto lanes = static_cast<std::int32_t>(hn::Lanes(d));
    if (count > 2 * hn::Lanes(d)) return hn::GatherIndex(d, of, level);
    const auto at = hn::IndicesFromVec(d, hn::And(level, hn::Set(di, lanes - 1)));
    const V low = hn::TableLookupLanes(hn::LoadU(d, of), at);
    const V high = hn::TableLookupLanes(hn::LoadU(d, of + lanes), at);
    return hn::IfThenElse(hn::RebindMask(d, hn::Lt(level, hn::Set(di, lanes))), low, high);
  }

  // Each lane's in a level of its own.
  void find_mixed_rows(Vi level, Vi nearer, Vi other, Taps& taps) const {
    const Di di;
    HWY_ALIGN std::int32_t levels[max_lanes], offset[2][max_lanes];
    hn::Store(level, di, levels);
    hn::Store(nearer, di, offset[0]);
    hn::Store(other, di, offset[1]);
    for (std::size_t r = 0; r < 2; ++r)
      for (std::size_t lane = 0; lane < hn::Lanes(di); ++lane)
        taps.row[r][lane] = reinterpret_cast<std::int64_t>(rgba[levels[lane]] + offset[r][lane]);
  }

  HWY_INLINE void find_taps(const TexelPyramid& p, V s, V t, Vi level, Taps& taps) const {
    const D d;
    const Di di;
    // Points beside one another mostly read the same level.
    const auto one = static_cast<std::size_t>(hn::GetLane(level));
    const bool same = hn::AllTrue(di, hn::Eq(level, hn::Set(di, hn::GetLane(level))));
    const V columns = same ? hn::Set(d, width[one]) : pick(width, level);
    const V rows = same ? hn::Set(d, height[one]) : pick(height, level);
    const Pair x = texel_pair(s, columns, p.wrap_u), y = texel_pair(t, rows, p.wrap_v);
    const Vi stride = hn::ConvertTo(di, columns), step = hn::Sub(x.second, x.first);
    const V fy = from_nearer(y.fraction);
    const auto lower = hn::RebindMask(di, is_second_nearer(fy));
    const auto offset = [&](Vi row)
                            HWY_ATTR { return hn::ShiftLeft<2>(hn::Add(hn::Mul(row, stride), x.first)); };
    const Vi nearer = offset(hn::IfThenElse(lower, y.second, y.first)),
             other = offset(hn::IfThenElse(lower, y.first, y.second));
    if (same) {
      find_rows(rgba[one], nearer, taps.row[0]);
      find_rows(rgba[one], other, taps.row[1]);
    } else {
      find_mixed_rows(level, nearer, other, taps);
    }
    // A small level stays in the cache, and along one row of a large one the processor fetches ahead by itself.
    const bool known = same && (width[one] * height[one] * (4 * sizeof(T)) <= cached_bytes ||
                                hn::AllTrue(di, hn::Eq(y.first, hn::Set(di, hn::GetLane(y.first)))));
    for (std::size_t lane = 0; lane < hn::Lanes(di) && !known; ++lane) {
      hwy::Prefetch(texel_at<T>(taps.row[0][lane]));
      hwy::Prefetch(texel_at<T>(taps.row[1][lane]));
    }
    hn::Store(hn::ShiftLeft<2>(step), di, taps.step);
    taps.adjacent = hn::AllTrue(di, hn::Eq(step, hn::Set(di, 1)));
    taps.fx = from_nearer(x.fraction), taps.fy = hn::Abs(fy);
  }
};

// One vector of points of bilinear or trilinear lookup, in two steps: where it reads, and the reading.
template <class T>
struct PyramidPoints {
  M inside;
  bool any, blends;
  V fraction;
  Taps near, far;

  HWY_INLINE void find(const TexelPyramid& p, const LevelTable<T>& table, Lookup kind,
                       const UvRows<float>& row) {
    const D d;
    const Di di;
    inside = covered(row);
    any = !hn::AllFalse(d, inside);
    if (!any) return;
    // Points that see nothing read a texel, too, and drop it.
    const V s = fold(hn::LoadU(d, row.u), p.wrap_u);
    const V t = hn::Sub(hn::Set(d, 1.0F), fold(hn::LoadU(d, row.v), p.wrap_v));
    V level = hn::Zero(d);
    if (kind == Lookup::trilinear)
      level = pyramid_level(row, p.levels[0], static_cast<int>(p.levels.size()) - 1);
    const Vi fine = hn::ConvertTo(di, level);
    const V beyond = hn::Sub(level, hn::ConvertTo(d, fine));
    blends = !hn::AllFalse(d, hn::Gt(beyond, hn::Zero(d)));
    fraction = from_nearer(beyond);
    table.find_taps(p, s, t, fine, near);
    if (blends) table.find_taps(p, s, t, hn::Add(fine, hn::Set(di, 1)), far);
  }

  HWY_INLINE void read(const RgbaRows<float>& rgba) const {
    const D d;
    if (!any) {
      for (std::size_t k = 0; k < 4; ++k) put(rgba, k, inside, hn::Zero(d));
      return;
    }
    HWY_ALIGN float color[4 * max_lanes];
    for (std::size_t g = 0; g < 4; ++g) {
      V c = fetch<T>(near, g);
      if (blends) {
        const V f = spread(fraction, g);
        c = hn::IfThenElse(hn::Ne(f, hn::Zero(d)), blend(c, fetch<T>(far, g), f), c);
      }
      hn::Store(c, d, color + g * hn::Lanes(d));
    }
    V channel[4];
    hn::LoadInterleaved4(d, color, channel[0], channel[1], channel[2], channel[3]);
    for (std::size_t k = 0; k < 4; ++k) put(rgba, k, inside, channel[k]);
  }
};

// ColorSum<float> in one vector.
struct VectorSum {
  explicit VectorSum(const Rgba<float>& from) : base(hn::LoadU(D4(), from.data())), sum(hn::Zero(D4())) {}
  void add(const float* texel, float w) {
    sum = hn::Add(sum, hn::Mul(hn::Set(D4(), w), hn::Sub(hn::LoadU(D4(), texel), base)));
  }
  Rgba<float> mean(float weights) const {
    Rgba<float> c;
    hn::StoreU(hn::Add(base, hn::Div(sum, hn::Set(D4(), weights))), D4(), c.data());
    return c;
  }
  hn::Vec<D4> base, sum;
};

void look_up_ellipses(const TexelPyramid& p, const Filtering& filter, const UvRows<float>& in, std::size_t n,
                      const RgbaRows<float>& out) {
  for (std::size_t x = 0; x < n; ++x)
    out.put(x, in.covers(x) ? elliptical<VectorSum>(p, in, x, static_cast<float>(filter.max_anisotropy))
                            : Rgba<float>{});
}

// Of `n` points, a whole number of vectors.
template <class T>
void look_up_vectors(const TexelPyramid& p, const Filtering& filter, const UvRows<float>& in, std::size_t n,
                     const RgbaRows<float>& out) {
  // The texels of so many vectors are asked for before the first is read: textures are larger than caches.
  constexpr std::size_t ahead = 4;
  const std::size_t lanes = hn::Lanes(D());
  const LevelTable<T> table(p);
  PyramidPoints<T> points[ahead];
  for (std::size_t x = 0; x < n; x += ahead * lanes) {
    const std::size_t count = std::min(ahead, (n - x) / lanes);
    for (std::size_t i = 0; i < count; ++i)
      points[i].find(p, table, filter.kind, advanced(in, x + i * lanes));
    for (std::size_t i = 0; i < count; ++i) points[i].read(advanced(out, x + i * lanes));
  }
}

void look_up_pyramid(const TexelPyramid& p, const Filtering& filter, const UvRows<float>& in, std::size_t n,
                     const RgbaRows<float>& out) {
  if (filter.kind == Lookup::ewa) return look_up_ellipses(p, filter, in, n, out);
  if ((filter.kind != Lookup::bilinear && filter.kind != Lookup::trilinear) || p.has_border())
    return kernels::look_up(p, filter, in, n, out);
  const std::size_t whole = n / hn::Lanes(D()) * hn::Lanes(D());
  if (p.levels[0].rgba != nullptr)
    look_up_vectors<float>(p, filter, in, whole, out);
  else
    look_up_vectors<std::uint16_t>(p, filter, in, whole, out);
  if (whole < n) kernels::look_up(p, filter, advanced(in, whole), n - whole, advanced(out, whole));
}

#endif

}  // namespace
}  // namespace frustum::kernels::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(look_up_pyramid);
HWY_EXPORT(look_up_checker);

void look_up(const TexelPyramid& pyramid, const Filtering& filter, const UvRows<float>& in, std::size_t n,
             const RgbaRows<float>& out) {
  HWY_DYNAMIC_DISPATCH(look_up_pyramid)(pyramid, filter, in, n, out);
}
void look_up(const CheckerColors<float>& checker, const Filtering& filter, const UvRows<float>& in,
             std::size_t n, const RgbaRows<float>& out) {
  HWY_DYNAMIC_DISPATCH(look_up_checker)(checker, filter, in, n, out);
}

}  // namespace frustum::kernels::simd
#endif
