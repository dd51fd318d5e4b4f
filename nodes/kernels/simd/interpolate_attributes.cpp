#include "nodes/kernels/simd/interpolate_attributes.h"

#include <hwy/cache_control.h>

#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/interpolate_attributes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/order-inl.h"

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
static_assert(stretch % hn::MaxLanes(Float()) == 0 && stretch <= 32 * 4);

using Quads = float[stretch][4];

// One stretch of one row: which faces are seen and the weights of their corners.
struct Points {
  HWY_ALIGN std::uint32_t face[stretch];       // no_face: nothing is seen
  HWY_ALIGN std::uint32_t held[stretch];       // the face, or a neighbour's where nothing is seen
  HWY_ALIGN std::uint32_t vertex[3][stretch];  // of the held face
  HWY_ALIGN std::int32_t base[stretch];
  HWY_ALIGN float u[stretch], v[stretch], u_dx[stretch], v_dx[stretch], u_dy[stretch], v_dy[stretch],
      w[stretch];
  HWY_ALIGN std::int32_t offset_x[stretch], offset_y[stretch];
  HWY_ALIGN Quads corner[3];  // screen corners, then attributes of the corners
  // Of a vector of points that see one face or two: these, the same twice for one; the lanes that `pair` tells apart.
  struct Pair {
    bool holds;
    std::uint32_t face[2];
    glm::uvec3 vertex[2];
    hn::Mask<Float> first;
  };
  Pair pair[stretch / hn::MaxLanes(Float())];

  HWY_INLINE Pair& pair_from(int i) { return pair[i / static_cast<int>(hn::Lanes(Float()))]; }
};

struct Stretch {
  int sample, x, y;  // absolute pixel of its first point
  int count;         // of pixels, 1 to `stretch`
};

// Asks for the corners and attributes of the faces seen, which lie anywhere in memory, well before they are
// used.
void prefetch(const AttributeScene<float>& scene, const AttributePlanes<float>& planes,
              const std::uint32_t* ids, int count) {
  std::uint32_t last = no_face;
  for (int i = 0; i < count; ++i) {
    if (ids[i] == last || ids[i] == no_face) continue;
    last = ids[i];
    const glm::uvec3 vertex = scene.mesh.face[last];
    for (int k = 0; k < 3; ++k) {
      hwy::Prefetch(&scene.mesh.position[vertex[k]]);
      for (const Attribute<float>& a : planes.attributes)
        if (a.domain == AttributeDomain::vertex)
          hwy::Prefetch(a.data + vertex[k] * static_cast<std::size_t>(a.width));
    }
  }
}

HWY_INLINE hn::Mask<Float> seen_from(const Points& p, int i) {
  const hn::RebindToUnsigned<Float> du;
  return hn::RebindMask(Float(), hn::Ne(hn::Load(du, p.face + i), hn::Set(du, no_face)));
}

// Loads the faces of the points from i on; returns whether any is seen. Points beyond the stretch see
// nothing.
HWY_INLINE bool load_faces(const std::uint32_t* ids, int count, int i, Points& p) {
  const hn::RebindToUnsigned<Float> du;
  if (i + static_cast<int>(hn::Lanes(du)) <= count) {
    hn::Store(hn::LoadU(du, ids + i), du, p.face + i);
  } else {
    hn::Store(hn::Set(du, no_face), du, p.face + i);
    for (int k = i; k < count; ++k) p.face[k] = ids[k];
  }
  return !hn::AllFalse(Float(), seen_from(p, i));
}

// Finds whether the points from i on see two faces at most.
HWY_INLINE bool find_pair(const AttributeScene<float>& scene, int i, Points& p) {
  const hn::RebindToUnsigned<Float> du;
  const auto face = hn::Load(du, p.face + i), none = hn::Set(du, no_face);
  const auto first_of = [&](auto mask) HWY_ATTR {
    return p.face[i + static_cast<int>(hn::FindKnownFirstTrue(du, mask))];
  };
  Points::Pair& pair = p.pair_from(i);
  const auto seen = hn::Ne(face, none);
  pair.face[0] = pair.face[1] = first_of(seen);
  const auto first = hn::Eq(face, hn::Set(du, pair.face[0])), others = hn::AndNot(first, seen);
  pair.first = hn::RebindMask(Float(), first);
  if (!hn::AllFalse(du, others)) pair.face[1] = first_of(others);
  pair.holds = hn::AllFalse(du, hn::And(others, hn::Ne(face, hn::Set(du, pair.face[1]))));
  for (int k = 0; k < 2 && pair.holds; ++k) pair.vertex[k] = scene.mesh.face[pair.face[k]];
  return pair.holds;
}

// Loads the screen corners of the points from i on, some of which see a face. The others hold a face, too, so
// that what is loaded for them exists.
void load_points(const AttributeScene<float>& scene, int i, Points& p) {
  if (find_pair(scene, i, p)) return;
  const int end = i + static_cast<int>(hn::Lanes(Float()));
  std::uint32_t held = p.pair_from(i).face[0];
  glm::uvec3 vertex = scene.mesh.face[held];
  for (; i < end; ++i) {
    const bool seen = p.face[i] != no_face;
    if (seen && p.face[i] != held) {
      held = p.face[i];
      vertex = scene.mesh.face[held];
    }
    p.held[i] = held;
    for (int k = 0; k < 3; ++k) {
      p.vertex[k][i] = vertex[k];
      std::memcpy(p.corner[k][i], &scene.mesh.position[vertex[k]].x, sizeof(p.corner[k][i]));
    }
  }
}

// Loads the offsets of the samples of the points from i on. Where all pixels have the same samples, they are
// there since the sample was begun.
void load_offsets(const SamplePositions& pattern, const Stretch& at, int i, Points& p) {
  if (pattern.period == 1) return;
  const std::size_t row = pattern.index(at.sample, 0, at.y);
  for (const int end = i + static_cast<int>(hn::Lanes(Float())); i < end; ++i) {
    const std::size_t k = row + static_cast<std::size_t>((at.x + i) & (pattern.period - 1));
    p.offset_x[i] = pattern.x[k];
    p.offset_y[i] = pattern.y[k];
  }
}

struct LaneCorners {
  Doubles x[3], y[3], per_w[3], q[3];
};

// The screen corners of the points of a vector: on the grid, and 1/w.
struct GridCorners {
  hn::Vec<hn::RebindToSigned<Float>> x[3], y[3];
  Floats per_w[3];

  HWY_INLINE GridCorners(const AttributeScene<float>& scene, Points& p, int i) {
    const Float df;
    const auto scale = hn::Set(df, static_cast<float>(1 << scene.mesh.corner_bits));
    const int shift = corner_bits - scene.mesh.corner_bits;
    const Points::Pair& pair = p.pair_from(i);
    for (int k = 0; k < 3; ++k) {
      Floats px, py, pz;
      if (pair.holds) {
        const glm::vec4 &a = scene.mesh.position[pair.vertex[0][k]],
                        &b = scene.mesh.position[pair.vertex[1][k]];
        px = hn::IfThenElse(pair.first, hn::Set(df, a.x), hn::Set(df, b.x));
        py = hn::IfThenElse(pair.first, hn::Set(df, a.y), hn::Set(df, b.y));
        per_w[k] = hn::IfThenElse(pair.first, hn::Set(df, a.w), hn::Set(df, b.w));
      } else {
        hn::LoadInterleaved4(df, p.corner[k][i], px, py, pz, per_w[k]);
      }
      x[k] = hn::ShiftLeftSame(hn::NearestInt(hn::Mul(px, scale)), shift);
      y[k] = hn::ShiftLeftSame(hn::NearestInt(hn::Mul(py, scale)), shift);
    }
  }

  // Of the lower or the upper half of the lanes.
  template <bool upper>
  HWY_INLINE LaneCorners half(const AttributeScene<float>& scene) const {
    const Double dd;
    const auto part = [&](auto v) HWY_ATTR {
      const hn::Half<hn::DFromV<decltype(v)>> dh;
      if constexpr (upper)
        return hn::PromoteTo(dd, hn::UpperHalf(dh, v));
      else
        return hn::PromoteTo(dd, hn::LowerHalf(dh, v));
    };
    LaneCorners c;
    for (int k = 0; k < 3; ++k) {
      c.x[k] = part(x[k]), c.y[k] = part(y[k]), c.per_w[k] = part(per_w[k]);
      c.q[k] = scene.interpolation == Interpolation::hyperbolic ? c.per_w[k] : hn::Set(dd, 1.0);
    }
    return c;
  }
};

// WeightedCorners::at for the points from i on.
template <bool differentiate>
HWY_INLINE void weigh(const AttributeScene<float>& scene, const LaneCorners& c, const Stretch& at, int i,
                      Points& p) {
  const Double dd;
  const HalfFloat df;
  const HalfInt di;
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

// Copies the attribute of the corners of the points from i on, four numbers apart.
template <int width>
HWY_INLINE void load_attribute(const Attribute<float>& a, int i, Points& p) {
  const int lanes = static_cast<int>(hn::Lanes(Float()));
  HWY_ALIGN std::uint32_t corner_rows[hn::MaxLanes(Float())];
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t* rows = p.vertex[k] + i;
    if (a.domain == AttributeDomain::face) rows = p.held + i;
    if (a.domain == AttributeDomain::corner) {
      for (int l = 0; l < lanes; ++l) corner_rows[l] = 3 * p.held[i + l] + k;
      rows = corner_rows;
    }
    for (int l = 0; l < lanes; ++l)
      std::memcpy(p.corner[k][i + l], a.data + std::size_t{rows[l]} * width, sizeof(float) * width);
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

// An attribute over the points of a vector: the value at the corner of greatest weight, what the other two add
// to it, and the range of the three.
struct Corners {
  Floats first, ab, ac, least, greatest;
};

HWY_INLINE Corners corners_of(Floats a, Floats b, Floats c) {
  return {a, hn::Sub(b, a), hn::Sub(c, a), lesser(c, lesser(b, a)), greater(c, greater(b, a))};
}

// interpolate_attribute for one component, at the points from i on.
HWY_INLINE void interpolate_component(const Attribute<float>& a, std::size_t component, const Corners& c,
                                      const Stretch& at, const PixelRect& rect, int i, const Points& p) {
  const Float df;
  const auto seen = seen_from(p, i);
  if (a.value[component].data != nullptr) {
    const auto u = hn::Load(df, p.u + i), v = hn::Load(df, p.v + i);
    const Floats value = hn::Add(hn::Add(c.first, hn::Mul(u, c.ab)), hn::Mul(v, c.ac));
    put(a.value[component], at, rect, i, seen, held_between(value, c.least, c.greatest));
  }
  const auto slope = [&](const PlaneView<float>& plane, const float* du, const float* dv) {
    if (plane.data == nullptr) return;
    put(plane, at, rect, i, seen,
        hn::Add(hn::Mul(hn::Load(df, du + i), c.ab), hn::Mul(hn::Load(df, dv + i), c.ac)));
  };
  slope(a.dx[component], p.u_dx, p.v_dx);
  slope(a.dy[component], p.u_dy, p.v_dy);
}

HWY_INLINE bool one_base(const Points& p, int i) {
  const hn::RebindToSigned<Float> di;
  return hn::AllTrue(di, hn::Eq(hn::Load(di, p.base + i), hn::Set(di, p.base[i])));
}

template <int width>
void interpolate(const Attribute<float>& a, const AttributeScene<float>& scene, const Stretch& at,
                 const PixelRect& rect, int i, Points& p) {
  const Float df;
  const Points::Pair& pair = p.pair_from(i);
  // With one base in all lanes the corners are turned, and no lane needs to pick.
  const bool turned = one_base(p, i);
  const int t = turned ? p.base[i] : 0, corner[3] = {t, (t + 1) % 3, (t + 2) % 3};
  Floats all[3][4];
  for (int k = 0; k < 3; ++k) {
    if (pair.holds) {
      const auto numbers = [&](int f) { return a.data + width * a.row(scene.mesh, pair.face[f], corner[k]); };
      const float *one = numbers(0), *other = numbers(1);
      for (std::size_t c = 0; c < width; ++c)
        all[k][c] = hn::IfThenElse(pair.first, hn::Set(df, one[c]), hn::Set(df, other[c]));
    } else {
      hn::LoadInterleaved4(df, p.corner[corner[k]][i], all[k][0], all[k][1], all[k][2], all[k][3]);
    }
  }
  const hn::RebindToSigned<Float> di;
  const auto base = hn::Load(di, p.base + i);
  const auto first = hn::RebindMask(df, hn::Eq(base, hn::Zero(di)));
  const auto second = hn::RebindMask(df, hn::Eq(base, hn::Set(di, 1)));
  const auto pick = [&](Floats x, Floats y, Floats z)
                        HWY_ATTR { return hn::IfThenElse(first, x, hn::IfThenElse(second, y, z)); };
  for (std::size_t c = 0; c < width; ++c) {
    const Floats x = all[0][c], y = all[1][c], z = all[2][c];
    const Corners corners =
        turned ? corners_of(x, y, z) : corners_of(pick(x, y, z), pick(y, z, x), pick(z, x, y));
    interpolate_component(a, c, corners, at, rect, i, p);
  }
}

// Fills points [begin, end) of a stretch, which see nothing.
void fill_empty(const AttributePlanes<float>& planes, const Stretch& at, const PixelRect& rect, int begin,
                int end) {
  const Float df;
  const hn::CappedTag<float, 1> one;
  const int lanes = static_cast<int>(hn::Lanes(df));
  const auto clear = [&](const PlaneView<float>& plane) {
    if (plane.data == nullptr) return;
    float* row = plane.row(at.sample, at.y - rect.y0) + (at.x - rect.x0);
    // Not std::fill: for so few numbers the compiler's `rep stos` costs more than all else here.
    int i = begin;
    for (; i + lanes <= end; i += lanes) hn::StoreU(hn::Zero(df), df, row + i);
    for (; i < end; ++i) hn::StoreU(hn::Zero(one), one, row + i);
  };
  clear(planes.w);
  for (const Attribute<float>& a : planes.attributes)
    for (std::size_t c = 0; c < static_cast<std::size_t>(a.width); ++c) {
      clear(a.value[c]);
      clear(a.dx[c]);
      clear(a.dy[c]);
    }
}

// Calls visit(i) for the vectors of the stretch in which something is seen.
template <class Visit>
HWY_INLINE void each_seen(std::uint32_t seen, Visit&& visit) {
  for (; seen != 0; seen &= seen - 1) visit(std::countr_zero(seen) * static_cast<int>(hn::Lanes(Float())));
}

template <int width>
void interpolate_stretch(const Attribute<float>& a, const AttributeScene<float>& scene, const Stretch& at,
                         const PixelRect& rect, std::uint32_t seen, Points& p) {
  // All copies come before all uses: a wide load waits until the narrow stores it covers have left the store
  // queue.
  each_seen(seen, [&](int i) {
    if (!p.pair_from(i).holds) load_attribute<width>(a, i, p);
  });
  each_seen(seen, [&](int i) { interpolate<width>(a, scene, at, rect, i, p); });
}

// Loads the faces of a stretch; returns a bit for each vector of points that sees any.
HWY_INLINE std::uint32_t load_stretch(const std::uint32_t* ids, int count, Points& p) {
  const int lanes = static_cast<int>(hn::Lanes(Float()));
  std::uint32_t seen = 0;
  for (int i = 0; i < count; i += lanes)
    if (load_faces(ids, count, i, p)) seen |= 1u << (i / lanes);
  return seen;
}

void fill_stretch(const AttributeScene<float>& scene, const AttributePlanes<float>& planes,
                  bool differentiate, const Stretch& at, const PixelRect& rect, std::uint32_t seen,
                  Points& p) {
  const int lanes = static_cast<int>(hn::Lanes(Float()));
  for (int i = 0; i < at.count; i += lanes)
    if ((seen >> (i / lanes) & 1) == 0) fill_empty(planes, at, rect, i, std::min(i + lanes, at.count));
  each_seen(seen, [&](int i) {
    load_points(scene, i, p);
    load_offsets(scene.pattern, at, i, p);
  });
  each_seen(seen, [&](int i) {
    const GridCorners corners(scene, p, i);
    const LaneCorners lower = corners.half<false>(scene), upper = corners.half<true>(scene);
    const int middle = i + static_cast<int>(hn::Lanes(Double()));
    if (differentiate) {
      weigh<true>(scene, lower, at, i, p);
      weigh<true>(scene, upper, at, middle, p);
    } else {
      weigh<false>(scene, lower, at, i, p);
      weigh<false>(scene, upper, at, middle, p);
    }
  });
  each_seen(seen, [&](int i) { put(planes.w, at, rect, i, seen_from(p, i), hn::Load(Float(), p.w + i)); });
  for (const Attribute<float>& a : planes.attributes) {
    if (a.width == 1)
      interpolate_stretch<1>(a, scene, at, rect, seen, p);
    else if (a.width == 2)
      interpolate_stretch<2>(a, scene, at, rect, seen, p);
    else if (a.width == 3)
      interpolate_stretch<3>(a, scene, at, rect, seen, p);
    else
      interpolate_stretch<4>(a, scene, at, rect, seen, p);
  }
}

}  // namespace

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes) {
  const bool differentiate = std::any_of(planes.attributes.begin(), planes.attributes.end(),
                                         [](const Attribute<float>& a) { return a.differentiates(); });
  Points points{};
  for (int s = 0; s < scene.pattern.samples; ++s) {
    const auto sample = static_cast<std::size_t>(s);
    std::fill_n(points.offset_x, stretch, std::int32_t{scene.pattern.x[sample]});
    std::fill_n(points.offset_y, stretch, std::int32_t{scene.pattern.y[sample]});
    for (int y = rect.y0; y < rect.y1; ++y) {
      const std::uint32_t* ids = id.row(s, y - rect.y0);
      if (y + 1 < rect.y1) prefetch(scene, planes, ids + id.row_stride, rect.x1 - rect.x0);
      int empty = rect.x0;  // from there to x nothing is seen, nor is it filled yet
      const auto clear_to = [&](int x) HWY_ATTR {
        if (empty < x) fill_empty(planes, {s, empty, y, x - empty}, rect, 0, x - empty);
      };
      for (int x = rect.x0; x < rect.x1; x += stretch) {
        const Stretch at{s, x, y, std::min(stretch, rect.x1 - x)};
        const std::uint32_t seen = load_stretch(ids + (x - rect.x0), at.count, points);
        if (seen == 0) continue;
        clear_to(x);
        fill_stretch(scene, planes, differentiate, at, rect, seen, points);
        empty = x + at.count;
      }
      clear_to(rect.x1);
    }
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
