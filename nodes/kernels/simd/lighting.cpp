#include "nodes/kernels/simd/lighting.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/lighting.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/elementary-inl.h"

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using Du = hn::RebindToUnsigned<D>;
using V = hn::Vec<D>;
using M = hn::Mask<D>;
using V3 = std::array<V, 3>;

template <class T, std::size_t n>
std::array<T*, n> advanced(std::array<T*, n> rows, std::size_t x) {
  for (T*& row : rows)
    if (row != nullptr) row += x;
  return rows;
}

HWY_INLINE M selected(Selection which, std::size_t x) {
  const D d;
  const Du du;
  const auto tag = hn::LoadU(du, which.tag + x), wanted = hn::Set(du, which.wanted);
  return hn::RebindMask(d, which.wanted == nothing_there ? hn::Ne(tag, wanted) : hn::Eq(tag, wanted));
}

HWY_INLINE V3 load3(const std::array<const float*, 3>& rows, std::size_t x) {
  const D d;
  return {hn::LoadU(d, rows[0] + x), hn::LoadU(d, rows[1] + x), hn::LoadU(d, rows[2] + x)};
}

HWY_INLINE V3 set3(const Triple<float>& t) {
  const D d;
  return {hn::Set(d, t[0]), hn::Set(d, t[1]), hn::Set(d, t[2])};
}

HWY_INLINE V3 sub3(const V3& a, const V3& b) {
  return {hn::Sub(a[0], b[0]), hn::Sub(a[1], b[1]), hn::Sub(a[2], b[2])};
}
HWY_INLINE V3 add3(const V3& a, const V3& b) {
  return {hn::Add(a[0], b[0]), hn::Add(a[1], b[1]), hn::Add(a[2], b[2])};
}
HWY_INLINE V3 scale3(const V3& a, V s) { return {hn::Mul(a[0], s), hn::Mul(a[1], s), hn::Mul(a[2], s)}; }

HWY_INLINE V dot(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

HWY_INLINE V3 unit(const V3& v) {
  const D d;
  const V square = dot(v, v);
  const V inverse = hn::Div(hn::Set(d, 1.0F), hn::Sqrt(square));
  return scale3(v, hn::IfThenElseZero(hn::Gt(square, hn::Zero(d)), inverse));
}

HWY_INLINE V power(const Exponent<float>& e, V x) {
  const D d;
  if (e.whole < 0) return frustum::HWY_NAMESPACE::pow(d, x, hn::Set(d, e.shininess));
  V result = hn::Set(d, 1.0F);
  for (int bits = e.whole; bits != 0; bits >>= 1, x = hn::Mul(x, x))
    if ((bits & 1) != 0) result = hn::Mul(result, x);
  return result;
}

HWY_INLINE V highlight_cosine_of(Highlight kind, const V3& n, const V3& l, const V3& v, V n_l) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  V x;
  if (kind == Highlight::phong) {
    x = hn::Sub(hn::Mul(hn::Mul(hn::Set(d, 2.0F), n_l), dot(n, v)), dot(l, v));
  } else {
    const V3 h = add3(l, v);
    const V square = dot(h, h);
    x = hn::IfThenElseZero(hn::Gt(square, zero), hn::Div(dot(n, h), hn::Sqrt(square)));
  }
  x = hn::IfThenElseZero(hn::Gt(x, zero), x);
  return hn::IfThenElse(hn::Lt(x, one), x, one);
}

// One vector of points whose light is worth computing.
HWY_INLINE void receive_vector(const LightSetup<float>& s, const PointRows<float>& in, std::size_t x,
                               const LightRows<float>& out) {
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0F);
  V3 normal = load3(in.normal, x);
  if (in.sign != nullptr) normal = scale3(normal, hn::LoadU(d, in.sign + x));
  const V3 n = unit(normal);
  V3 p{zero, zero, zero}, v{zero, zero, zero};
  if (in.position[0] != nullptr) p = load3(in.position, x);
  if (s.highlight != Highlight::none) v = unit(sub3(set3(s.eye), p));
  V3 diffuse{zero, zero, zero}, specular{zero, zero, zero};
  for (std::size_t i = 0; i < s.lights.size(); ++i) {
    const LightSource<float>& light = s.lights[i];
    const float* reach = in.reach_of(i);
    V3 l = set3(light.place);
    V strength = reach == nullptr ? one : hn::LoadU(d, reach + x);
    if (light.is_point) {
      const V3 to = sub3(l, p), a = set3(light.attenuation);
      const V square = dot(to, to), distance = hn::Sqrt(square);
      l = unit(to);
      if (light.falls_off) {
        V weaker = hn::Div(one, hn::Add(hn::Add(a[0], hn::Mul(a[1], distance)), hn::Mul(a[2], square)));
        const V most = hn::Set(d, static_cast<float>(greatest_strength));
        weaker = hn::IfThenElse(hn::Lt(weaker, most), weaker, most);
        strength = hn::Mul(strength, weaker);
      }
      if (light.is_spot) {
        V t = hn::Sub(hn::Set(d, light.cone_offset),
                      hn::Mul(dot(l, set3(light.axis)), hn::Set(d, light.cone_scale)));
        t = hn::IfThenElseZero(hn::Gt(t, zero), t);
        t = hn::IfThenElse(hn::Lt(t, one), t, one);
        strength = hn::Mul(strength, hn::Mul(t, t));
      }
      if (light.is_patch) {
        const V cosine = hn::Neg(dot(l, set3(light.axis)));
        strength = hn::Mul(strength, hn::IfThenElseZero(hn::Gt(cosine, zero), cosine));
      }
    }
    const V n_l = dot(n, l);
    const M lit = hn::Gt(n_l, zero);
    const V scattered = hn::Mul(n_l, strength);
    const V3 color = set3(light.color);
    for (std::size_t k = 0; k < 3; ++k)
      diffuse[k] = hn::Add(diffuse[k], hn::IfThenElseZero(lit, hn::Mul(color[k], scattered)));
    if (s.highlight == Highlight::none || hn::AllFalse(d, lit)) continue;
    const V mirrored = hn::Mul(power(s.exponent, highlight_cosine_of(s.highlight, n, l, v, n_l)), strength);
    for (std::size_t k = 0; k < 3; ++k)
      specular[k] = hn::Add(specular[k], hn::IfThenElseZero(lit, hn::Mul(color[k], mirrored)));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    hn::StoreU(diffuse[k], d, out.diffuse[k] + x);
    if (out.specular[k] != nullptr) hn::StoreU(specular[k], d, out.specular[k] + x);
  }
}

// The last, partial vector of a row is left to the scalar twin, which has the same bits.

void receive(const LightSetup<float>& s, const PointRows<float>& in, Selection which, std::size_t n,
             const LightRows<float>& out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t x = 0;
  for (; x + lanes <= n; x += lanes)
    if (!hn::AllFalse(d, selected(which, x))) receive_vector(s, in, x, out);
  if (x < n)
    kernels::receive_light<float>(s,
                                  {advanced(in.normal, x), advanced(in.position, x),
                                   in.sign == nullptr ? nullptr : in.sign + x, in.reach, in.first + x},
                                  {which.tag + x, which.wanted}, n - x,
                                  {advanced(out.diffuse, x), advanced(out.specular, x)});
}

void reflect(const SurfaceColors<float>& c, const LightInput<float>& light,
             const std::array<const float*, 3>& albedo, const float* opacity, Selection which, bool keep,
             std::size_t n, const ColorRows<float>& out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t x = 0;
  for (; x + lanes <= n; x += lanes) {
    const M inside = selected(which, x);
    if (keep && hn::AllFalse(d, inside)) continue;
    const auto put = [&](std::size_t k, V value) HWY_ATTR {
      float* to = out.plane[k] + x;
      hn::StoreU(keep ? hn::IfThenElse(inside, value, hn::LoadU(d, to)) : hn::IfThenElseZero(inside, value),
                 d, to);
    };
    for (std::size_t k = 0; k < 3; ++k) {
      if (out.plane[k] == nullptr) continue;
      V color = hn::Mul(hn::Set(d, c.diffuse[k]), hn::LoadU(d, light.diffuse[k] + x));
      if (c.adds_ambient) color = hn::Add(hn::Set(d, c.ambient[k]), color);
      if (albedo[k] != nullptr) color = hn::Mul(hn::LoadU(d, albedo[k] + x), color);
      if (light.specular[k] != nullptr)
        color = hn::Add(color, hn::Mul(hn::Set(d, c.specular[k]), hn::LoadU(d, light.specular[k] + x)));
      color = hn::Add(color, hn::Set(d, c.emission[k]));
      put(k, opacity != nullptr ? hn::Mul(color, hn::LoadU(d, opacity + x)) : color);
    }
    if (out.plane[3] != nullptr) put(3, opacity != nullptr ? hn::LoadU(d, opacity + x) : hn::Set(d, 1.0F));
  }
  if (x < n)
    kernels::reflect_light<float>(c, {advanced(light.diffuse, x), advanced(light.specular, x)},
                                  advanced(albedo, x), opacity == nullptr ? nullptr : opacity + x,
                                  {which.tag + x, which.wanted}, keep, n - x, {advanced(out.plane, x)});
}

void look_up(std::span<const float> table, const std::uint32_t* id, std::size_t n, float* out) {
  const D d;
  const Du du;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t x = 0;
  for (; x + lanes <= n; x += lanes) {
    const std::uint32_t first = id[x];
    if (hn::AllTrue(du, hn::Eq(hn::LoadU(du, id + x), hn::Set(du, first))))
      hn::StoreU(hn::Set(d, first < table.size() ? table[first] : 1.0F), d, out + x);
    else
      kernels::numbers_of_faces<float>(table, id + x, lanes, out + x);
  }
  kernels::numbers_of_faces<float>(table, id + x, n - x, out + x);
}

// One vector of pixels; false where none of them has a face left.
HWY_INLINE bool take_vector(std::uint32_t* left, std::size_t samples, std::size_t n, std::size_t x,
                            std::span<const float* const> in, std::uint32_t* face,
                            std::span<float* const> mean) {
  const D d;
  const Du du;
  const auto none = hn::Set(du, nothing_there);
  auto id = none;
  for (std::size_t s = samples; s-- > 0;) {
    const auto mine = hn::LoadU(du, left + s * n + x);
    id = hn::IfThenElse(hn::Eq(mine, none), id, mine);
  }
  hn::StoreU(id, du, face + x);
  const auto has_face = hn::Ne(id, none);
  if (hn::AllFalse(du, has_face)) return false;
  const auto matches = [&](std::size_t s) HWY_ATTR {
    return hn::RebindMask(d, hn::And(hn::Eq(hn::LoadU(du, left + s * n + x), id), has_face));
  };
  V count = hn::Zero(d);
  for (std::size_t s = 0; s < samples; ++s)
    count = hn::Add(count, hn::IfThenElseZero(matches(s), hn::Set(d, 1.0F)));
  // Three planes at a time: as many sums as stay in registers beside the masks.
  for (std::size_t p = 0; p < mean.size(); p += 3) {
    const std::size_t planes = std::min<std::size_t>(3, mean.size() - p);
    V3 sum{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
    for (std::size_t s = 0; s < samples; ++s) {
      const M match = matches(s);
      for (std::size_t k = 0; k < planes; ++k)
        sum[k] = hn::Add(sum[k], hn::IfThenElseZero(match, hn::LoadU(d, in[(p + k) * samples + s] + x)));
    }
    for (std::size_t k = 0; k < planes; ++k) hn::StoreU(hn::Div(sum[k], count), d, mean[p + k] + x);
  }
  for (std::size_t s = 0; s < samples; ++s) {
    std::uint32_t* to = left + s * n + x;
    const auto mine = hn::LoadU(du, to);
    hn::StoreU(hn::IfThenElse(hn::Eq(mine, id), none, mine), du, to);
  }
  return true;
}

bool take(std::uint32_t* left, std::size_t samples, std::size_t n, std::span<const float* const> in,
          std::uint32_t* face, std::span<float* const> mean) {
  const std::size_t lanes = hn::Lanes(D());
  bool any = false;
  std::size_t x = 0;
  for (; x + lanes <= n; x += lanes) any = take_vector(left, samples, n, x, in, face, mean) || any;
  return kernels::take_face(left, samples, n, x, n, in, face, mean) || any;
}

void put(const std::uint32_t* id, const std::uint32_t* face, std::size_t n, const ColorRows<float>& from,
         const ColorRows<float>& to) {
  const D d;
  const Du du;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t x = 0;
  for (; x + lanes <= n; x += lanes) {
    const auto f = hn::LoadU(du, face + x);
    const auto match = hn::And(hn::Eq(hn::LoadU(du, id + x), f), hn::Ne(f, hn::Set(du, nothing_there)));
    if (hn::AllFalse(du, match)) continue;
    const M here = hn::RebindMask(d, match);
    for (std::size_t k = 0; k < 4; ++k) {
      float* out = to.plane[k];
      if (out == nullptr) continue;
      hn::StoreU(hn::IfThenElse(here, hn::LoadU(d, from.plane[k] + x), hn::LoadU(d, out + x)), d, out + x);
    }
  }
  kernels::put_face(id, face, x, n, from, to);
}

}  // namespace
}  // namespace frustum::kernels::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(receive);
HWY_EXPORT(reflect);
HWY_EXPORT(look_up);
HWY_EXPORT(take);
HWY_EXPORT(put);

void receive_light(const LightSetup<float>& setup, const PointRows<float>& in, Selection which, std::size_t n,
                   const LightRows<float>& out) {
  HWY_DYNAMIC_DISPATCH(receive)(setup, in, which, n, out);
}
void reflect_light(const SurfaceColors<float>& colors, const LightInput<float>& light,
                   const std::array<const float*, 3>& albedo, const float* opacity, Selection which,
                   bool keep, std::size_t n, const ColorRows<float>& out) {
  HWY_DYNAMIC_DISPATCH(reflect)(colors, light, albedo, opacity, which, keep, n, out);
}
void numbers_of_faces(std::span<const float> table, const std::uint32_t* id, std::size_t n, float* out) {
  HWY_DYNAMIC_DISPATCH(look_up)(table, id, n, out);
}
bool take_face(std::uint32_t* left, std::size_t samples, std::size_t n, std::span<const float* const> in,
               std::uint32_t* face, std::span<float* const> mean) {
  return HWY_DYNAMIC_DISPATCH(take)(left, samples, n, in, face, mean);
}
void put_face(const std::uint32_t* id, const std::uint32_t* face, std::size_t n, const ColorRows<float>& from,
              const ColorRows<float>& to) {
  HWY_DYNAMIC_DISPATCH(put)(id, face, n, from, to);
}

}  // namespace frustum::kernels::simd
#endif
