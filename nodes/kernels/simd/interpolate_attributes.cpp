#include "nodes/kernels/simd/interpolate_attributes.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/interpolate_attributes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::ScalableTag<float>;
using Double = hn::ScalableTag<double>;
using HalfFloat = hn::Rebind<float, Double>;  // as many lanes as Double has
using HalfInt = hn::Rebind<std::int32_t, Double>;
using Floats = hn::Vec<Float>;
using Doubles = hn::Vec<Double>;

// A row is worked in stretches of this many pixels, so that what passes between the steps stays in the first
// cache.
constexpr int stretch = 64;
static_assert(stretch % hn::MaxLanes(Float()) == 0);

using Quads = float[stretch][4];

// One stretch of one row: which faces are seen and the weights of their corners.
struct Points {
  HWY_ALIGN std::uint32_t face[stretch];  // no_face: nothing is seen
  HWY_ALIGN std::int32_t base[stretch];
  HWY_ALIGN float u[stretch], v[stretch], u_dx[stretch], v_dx[stretch], u_dy[stretch], v_dy[stretch],
      w[stretch];
  HWY_ALIGN std::int32_t offset_x[stretch], offset_y[stretch];
  HWY_ALIGN Quads corner[3];  // screen corners, then attributes of the corners
};

struct Stretch {
  int sample, x, y;  // absolute pixel of its first point
  int count;         // of pixels, 1 to `stretch`
};

// Stands in where nothing is seen; its weights are finite and their use is masked.
constexpr float stand_in[3][4] = {{0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}};

// Returns whether anything is seen.
bool load_points(const AttributeScene<float>& scene, const Stretch& at, const std::uint32_t* ids, Points& p) {
  bool any = false;
  for (int i = 0; i < stretch; ++i) p.face[i] = i < at.count ? ids[i] : no_face;
  for (int i = 0; i < at.count; ++i) {
    any |= p.face[i] != no_face;
    const std::size_t k = scene.pattern.index(at.sample, at.x + i, at.y);
    p.offset_x[i] = scene.pattern.x[k];
    p.offset_y[i] = scene.pattern.y[k];
  }
  if (!any) return false;
  for (int i = 0; i < stretch; ++i) {
    const bool seen = p.face[i] != no_face;
    const glm::uvec3 vertex = seen ? scene.mesh.face[p.face[i]] : glm::uvec3(0);
    for (int k = 0; k < 3; ++k)
      std::memcpy(p.corner[k][i], seen ? &scene.mesh.position[vertex[k]].x : stand_in[k],
                  sizeof(p.corner[k][i]));
    if (i >= at.count) p.offset_x[i] = p.offset_y[i] = 0;
  }
  return true;
}

struct LaneCorners {
  Doubles x[3], y[3], per_w[3], q[3];
};

LaneCorners load_corners(const AttributeScene<float>& scene, const Points& p, int i) {
  const HalfFloat df;
  const Double dd;
  const auto scale = hn::Set(df, static_cast<float>(1 << scene.mesh.corner_bits));
  const int shift = corner_bits - scene.mesh.corner_bits;
  LaneCorners c;
  for (int k = 0; k < 3; ++k) {
    hn::Vec<HalfFloat> x, y, z, w;
    hn::LoadInterleaved4(df, p.corner[k][i], x, y, z, w);
    const auto snapped = [&](auto v) {
      return hn::PromoteTo(dd, hn::ShiftLeftSame(hn::NearestInt(hn::Mul(v, scale)), shift));
    };
    c.x[k] = snapped(x);
    c.y[k] = snapped(y);
    c.per_w[k] = hn::PromoteTo(dd, w);
    c.q[k] = scene.interpolation == Interpolation::hyperbolic ? c.per_w[k] : hn::Set(dd, 1.0);
  }
  return c;
}

// WeightedCorners::at for the points from i on.
template <bool differentiate>
void weigh(const AttributeScene<float>& scene, const Stretch& at, Points& p, int i) {
  const Double dd;
  const HalfFloat df;
  const HalfInt di;
  const LaneCorners c = load_corners(scene, p, i);
  const auto scale = hn::Set(dd, double{sample_unit / corner_unit}), unit = hn::Set(dd, double{sample_unit});
  const auto pixel = hn::PromoteTo(dd, hn::Iota(di, at.x + i));
  const auto sx = hn::Add(hn::Mul(pixel, unit), hn::PromoteTo(dd, hn::Load(di, p.offset_x + i)));
  const auto sy =
      hn::Add(hn::Set(dd, at.y * double{sample_unit}), hn::PromoteTo(dd, hn::Load(di, p.offset_y + i)));
  Doubles e[3], g[3], g_dx[3], g_dy[3], m[3];
  for (int k = 0; k < 3; ++k) {
    const int from = (k + 1) % 3, to = (k + 2) % 3;
    const auto ex = hn::Sub(c.x[to], c.x[from]), ey = hn::Sub(c.y[to], c.y[from]);
    e[k] = hn::Sub(hn::Mul(ex, hn::Sub(sy, hn::Mul(c.y[from], scale))),
                   hn::Mul(ey, hn::Sub(sx, hn::Mul(c.x[from], scale))));
    g[k] = hn::Mul(e[k], c.q[k]);
    g_dx[k] = hn::Mul(hn::Mul(ey, hn::Neg(unit)), c.q[k]);
    g_dy[k] = hn::Mul(hn::Mul(ex, unit), c.q[k]);
  }
  const auto sum = [](const Doubles(&v)[3]) { return hn::Add(hn::Add(v[0], v[1]), v[2]); };
  const auto inverse = hn::Div(hn::Set(dd, 1.0), sum(g));
  for (int k = 0; k < 3; ++k) m[k] = hn::Mul(g[k], inverse);

  const auto first = hn::And(hn::Ge(m[0], m[1]), hn::Ge(m[0], m[2])), second = hn::Ge(m[1], m[2]);
  const auto pick = [&](const Doubles& a, const Doubles& b, const Doubles& d) {
    return hn::IfThenElse(first, a, hn::IfThenElse(second, b, d));
  };
  const auto put = [&](const Doubles& v, float* to) { hn::Store(hn::DemoteTo(df, v), df, to + i); };
  hn::Store(hn::DemoteTo(di, pick(hn::Zero(dd), hn::Set(dd, 1.0), hn::Set(dd, 2.0))), di, p.base + i);
  put(pick(m[1], m[2], m[0]), p.u);
  put(pick(m[2], m[0], m[1]), p.v);
  if (scene.interpolation == Interpolation::affine) {
    Doubles d[3];
    for (int k = 0; k < 3; ++k) d[k] = hn::Div(hn::Set(dd, 1.0), c.per_w[k]);
    const auto a = pick(d[0], d[1], d[2]);
    const auto b = hn::Mul(pick(m[1], m[2], m[0]), hn::Sub(pick(d[1], d[2], d[0]), a));
    put(hn::Add(hn::Add(a, b), hn::Mul(pick(m[2], m[0], m[1]), hn::Sub(pick(d[2], d[0], d[1]), a))), p.w);
  } else {
    put(hn::Mul(sum(e), inverse), p.w);
  }
  if constexpr (differentiate) {
    const auto slope = [&](const Doubles(&of)[3], float* u, float* v) {
      const auto total = sum(of);
      Doubles d[3];
      for (int k = 0; k < 3; ++k) d[k] = hn::Mul(hn::Sub(of[k], hn::Mul(m[k], total)), inverse);
      put(pick(d[1], d[2], d[0]), u);
      put(pick(d[2], d[0], d[1]), v);
    };
    slope(g_dx, p.u_dx, p.v_dx);
    slope(g_dy, p.u_dy, p.v_dy);
  }
}

// Copies the attribute of the corners base, base + 1, base + 2 of each point, four numbers apart.
template <int width>
void load_attribute(const Attribute<float>& a, const ScreenMesh<float>& mesh, int count, Points& p) {
  const int modulo[5] = {0, 1, 2, 0, 1};
  for (int i = 0; i < count; ++i) {
    if (p.face[i] == no_face) continue;
    for (int k = 0; k < 3; ++k)
      std::memcpy(p.corner[k][i], a.data + a.row(mesh, p.face[i], modulo[p.base[i] + k]) * width,
                  sizeof(float) * width);
  }
}

// Writes the lanes of points that are seen, and 0 in the others.
HWY_INLINE void put(const PlaneView<float>& plane, const Stretch& at, const PixelRect& rect, int i,
                    hn::Mask<Float> seen, Floats value) {
  if (plane.data == nullptr) return;
  float* to = plane.row(at.sample, at.y - rect.y0) + (at.x - rect.x0) + i;
  value = hn::IfThenElseZero(seen, value);
  if (i + static_cast<int>(hn::Lanes(Float())) <= at.count) return hn::StoreU(value, Float(), to);
  HWY_ALIGN float all[hn::MaxLanes(Float())];
  hn::Store(value, Float(), all);
  std::copy_n(all, at.count - i, to);
}

HWY_INLINE hn::Mask<Float> seen_from(const Points& p, int i) {
  const hn::RebindToUnsigned<Float> du;
  return hn::RebindMask(Float(), hn::Ne(hn::Load(du, p.face + i), hn::Set(du, no_face)));
}

template <int width>
void interpolate(const Attribute<float>& a, const AttributeScene<float>& scene, const Stretch& at,
                 const PixelRect& rect, Points& p) {
  const Float df;
  load_attribute<width>(a, scene.mesh, at.count, p);
  for (int i = 0; i < at.count; i += static_cast<int>(hn::Lanes(df))) {
    const auto seen = seen_from(p, i);
    Floats corner[3][4];
    for (int k = 0; k < 3; ++k)
      hn::LoadInterleaved4(df, p.corner[k][i], corner[k][0], corner[k][1], corner[k][2], corner[k][3]);
    const auto u = hn::Load(df, p.u + i), v = hn::Load(df, p.v + i);
    for (std::size_t c = 0; c < width; ++c) {
      const Floats first = corner[0][c], second = corner[1][c], third = corner[2][c];
      const Floats ab = hn::Sub(second, first), ac = hn::Sub(third, first);
      if (a.value[c].data != nullptr) {
        const auto lesser = [](Floats x, Floats y) { return hn::IfThenElse(hn::Lt(y, x), y, x); };
        const auto greater = [](Floats x, Floats y) { return hn::IfThenElse(hn::Lt(x, y), y, x); };
        const Floats value = hn::Add(hn::Add(first, hn::Mul(u, ab)), hn::Mul(v, ac));
        const Floats raised = greater(value, lesser(lesser(first, second), third));
        put(a.value[c], at, rect, i, seen, lesser(raised, greater(greater(first, second), third)));
      }
      const auto slope = [&](const PlaneView<float>& plane, const float* du, const float* dv) {
        if (plane.data == nullptr) return;
        const auto change = hn::Add(hn::Mul(hn::Load(df, du + i), ab), hn::Mul(hn::Load(df, dv + i), ac));
        put(plane, at, rect, i, seen, change);
      };
      slope(a.dx[c], p.u_dx, p.v_dx);
      slope(a.dy[c], p.u_dy, p.v_dy);
    }
  }
}

void fill_empty(const AttributePlanes<float>& planes, const Stretch& at, const PixelRect& rect) {
  const auto clear = [&](const PlaneView<float>& plane) {
    if (plane.data != nullptr)
      std::fill_n(plane.row(at.sample, at.y - rect.y0) + (at.x - rect.x0), at.count, 0.0f);
  };
  clear(planes.w);
  for (const Attribute<float>& a : planes.attributes)
    for (std::size_t c = 0; c < static_cast<std::size_t>(a.width); ++c)
      clear(a.value[c]), clear(a.dx[c]), clear(a.dy[c]);
}

void fill_stretch(const AttributeScene<float>& scene, const AttributePlanes<float>& planes,
                  bool differentiate, const Stretch& at, const PixelRect& rect, const std::uint32_t* ids,
                  Points& p) {
  if (!load_points(scene, at, ids, p)) return fill_empty(planes, at, rect);
  for (int i = 0; i < at.count; i += static_cast<int>(hn::Lanes(Double())))
    differentiate ? weigh<true>(scene, at, p, i) : weigh<false>(scene, at, p, i);
  for (int i = 0; i < at.count; i += static_cast<int>(hn::Lanes(Float())))
    put(planes.w, at, rect, i, seen_from(p, i), hn::Load(Float(), p.w + i));
  for (const Attribute<float>& a : planes.attributes) {
    if (a.width == 1)
      interpolate<1>(a, scene, at, rect, p);
    else if (a.width == 2)
      interpolate<2>(a, scene, at, rect, p);
    else if (a.width == 3)
      interpolate<3>(a, scene, at, rect, p);
    else
      interpolate<4>(a, scene, at, rect, p);
  }
}

}  // namespace

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes) {
  const bool differentiate = std::any_of(planes.attributes.begin(), planes.attributes.end(),
                                         [](const Attribute<float>& a) { return a.differentiates(); });
  Points points{};
  for (int s = 0; s < scene.pattern.samples; ++s)
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; x += stretch) {
        const Stretch at{s, x, y, std::min(stretch, rect.x1 - x)};
        fill_stretch(scene, planes, differentiate, at, rect, id.row(s, y - rect.y0) + (x - rect.x0), points);
      }
}

#else  // without vectors the twin itself

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes) {
  kernels::interpolate_attributes<float>(scene, rect, id, planes);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(interpolate_attributes);

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes) {
  HWY_DYNAMIC_DISPATCH(interpolate_attributes)(scene, rect, id, planes);
}

}  // namespace frustum::kernels::simd
#endif
