// Points of a row of pixels, in lanes: which faces they see, the corners of these, and the weights of the corners.
// Compiled once for each SIMD target.
#if defined(FRUSTUM_ATTRIBUTE_POINTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FRUSTUM_ATTRIBUTE_POINTS_INL
#undef FRUSTUM_ATTRIBUTE_POINTS_INL
#else
#define FRUSTUM_ATTRIBUTE_POINTS_INL
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "nodes/kernels/interpolate_attributes.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
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
constexpr std::size_t max_lanes = hn::MaxLanes(Float());
static_assert(stretch % max_lanes == 0 && stretch <= 32 * 4);

// The corners of the faces of some points, in samples' units, and the edges opposite to them.
struct LaneEdges {
  Doubles x[3], y[3], edge_x[3], edge_y[3], per_w[3], q[3];

  // From corners on their own grid.
  HWY_INLINE void set(const Doubles (&cx)[3], const Doubles (&cy)[3], const Doubles (&w)[3],
                      Interpolation kind) {
    const Double dd;
    const auto scale = hn::Set(dd, double{sample_unit / corner_unit});
    for (int k = 0; k < 3; ++k) {
      const int from = (k + 1) % 3, to = (k + 2) % 3;
      x[k] = hn::Mul(cx[k], scale), y[k] = hn::Mul(cy[k], scale);
      edge_x[k] = hn::Sub(cx[to], cx[from]), edge_y[k] = hn::Sub(cy[to], cy[from]);
      per_w[k] = w[k];
      q[k] = kind == Interpolation::hyperbolic ? w[k] : hn::Set(dd, 1.0);
    }
  }
};

// The faces that a vector of points sees, in the order of its lanes, and which lanes see each. Points that see nothing
// go with the first.
struct LaneFaces {
  int count;
  std::uint32_t face[max_lanes];
  glm::uvec3 vertex[max_lanes];
  hn::Mask<Float> lanes[max_lanes];
};

// One stretch of one row: which faces are seen and the weights of their corners.
struct Points {
  HWY_ALIGN std::uint32_t face[stretch];  // no_face: nothing is seen
  HWY_ALIGN std::int32_t base[stretch];
  HWY_ALIGN float u[stretch], v[stretch], u_dx[stretch], v_dx[stretch], u_dy[stretch], v_dy[stretch],
      w[stretch];
  HWY_ALIGN std::int32_t offset_x[stretch], offset_y[stretch];
  LaneFaces faces[stretch / max_lanes];
  // Of the face that a vector of points saw alone the last time: the next one, or the next row, often sees the same.
  std::uint32_t face_of_edges;
  LaneEdges edges;

  HWY_INLINE LaneFaces& faces_from(int i) { return faces[i / static_cast<int>(hn::Lanes(Float()))]; }
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

// Finds the faces of the points from i on, one of which sees one at least.
HWY_INLINE void find_faces(const AttributeScene<float>& scene, int i, Points& p) {
  const hn::RebindToUnsigned<Float> du;
  const auto face = hn::Load(du, p.face + i);
  LaneFaces& faces = p.faces_from(i);
  faces.count = 0;
  for (auto left = hn::Ne(face, hn::Set(du, no_face)); !hn::AllFalse(du, left); ++faces.count) {
    const std::uint32_t next = p.face[i + static_cast<int>(hn::FindKnownFirstTrue(du, left))];
    const auto same = hn::Eq(face, hn::Set(du, next));
    left = hn::AndNot(same, left);
    faces.face[faces.count] = next;
    faces.vertex[faces.count] = scene.mesh.face[next];
    faces.lanes[faces.count] = hn::RebindMask(Float(), same);
  }
}

// Numbers of the corners of faces, by lane: find(f, from) points `from` to those of the f-th face. A broadcast under
// a mask is one instruction on some targets; copying them lane by lane took twice as long even where every lane sees
// a face of its own.
template <int width, class Find>
HWY_INLINE void load_corners(const LaneFaces& faces, Floats (&to)[3][width], const Find& find) {
  const Float df;
  const float* from[3];
  find(0, from);
  for (int k = 0; k < 3; ++k) {
    HWY_UNROLL(4)
    for (int c = 0; c < width; ++c) to[k][c] = hn::Set(df, from[k][c]);
  }
  for (int f = 1; f < faces.count; ++f) {
    find(f, from);
    const hn::Mask<Float> lanes = faces.lanes[f];
    for (int k = 0; k < 3; ++k) {
      HWY_UNROLL(4)
      for (int c = 0; c < width; ++c) to[k][c] = hn::IfThenElse(lanes, hn::Set(df, from[k][c]), to[k][c]);
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

// The screen corners of the points of a vector: on the grid, and 1/w.
struct GridCorners {
  hn::Vec<hn::RebindToSigned<Float>> x[3], y[3];
  Floats per_w[3];

  HWY_INLINE GridCorners(const AttributeScene<float>& scene, const LaneFaces& faces) {
    const Float df;
    const auto scale = hn::Set(df, static_cast<float>(1 << scene.mesh.corner_bits));
    const int shift = corner_bits - scene.mesh.corner_bits;
    Floats corner[3][4];
    load_corners(faces, corner, [&](int f, const float*(&from)[3]) HWY_ATTR {
      for (int k = 0; k < 3; ++k) from[k] = &scene.mesh.position[faces.vertex[f][k]].x;
    });
    for (int k = 0; k < 3; ++k) {
      x[k] = hn::ShiftLeftSame(hn::NearestInt(hn::Mul(corner[k][0], scale)), shift);
      y[k] = hn::ShiftLeftSame(hn::NearestInt(hn::Mul(corner[k][1], scale)), shift);
      per_w[k] = corner[k][3];
    }
  }

  // Of the lower or the upper half of the lanes.
  template <bool upper>
  HWY_INLINE void edges_of_half(Interpolation kind, LaneEdges& to) const {
    const Double dd;
    const auto part = [&](auto v) HWY_ATTR {
      const hn::Half<hn::DFromV<decltype(v)>> dh;
      if constexpr (upper)
        return hn::PromoteTo(dd, hn::UpperHalf(dh, v));
      else
        return hn::PromoteTo(dd, hn::LowerHalf(dh, v));
    };
    const Doubles cx[3] = {part(x[0]), part(x[1]), part(x[2])}, cy[3] = {part(y[0]), part(y[1]), part(y[2])},
                  w[3] = {part(per_w[0]), part(per_w[1]), part(per_w[2])};
    to.set(cx, cy, w, kind);
  }
};

// The edges of one face, in every lane.
void load_edges(const AttributeScene<float>& scene, std::uint32_t face, Points& p) {
  if (face == p.face_of_edges) return;
  const Double dd;
  const int bits = scene.mesh.corner_bits;
  Doubles x[3], y[3], w[3];
  for (int k = 0; k < 3; ++k) {
    const glm::vec4& corner = scene.mesh.position[scene.mesh.face[face][k]];
    x[k] = hn::Set(dd, static_cast<double>(snap(static_cast<double>(corner.x), bits)));
    y[k] = hn::Set(dd, static_cast<double>(snap(static_cast<double>(corner.y), bits)));
    w[k] = hn::Set(dd, static_cast<double>(corner.w));
  }
  p.edges.set(x, y, w, scene.interpolation);
  p.face_of_edges = face;
}

// WeightedCorners::at for the points from i on.
template <bool differentiate>
HWY_INLINE void weigh(const AttributeScene<float>& scene, const LaneEdges& c, const Stretch& at, int i,
                      Points& p) {
  const Double dd;
  const HalfFloat df;
  const HalfInt di;
  const auto unit = hn::Set(dd, double{sample_unit});
  // Not Iota from at.x + i: one from a number that is not a constant goes through memory, lane by lane.
  const auto pixel = hn::PromoteTo(dd, hn::Add(hn::Iota(di, 0), hn::Set(di, at.x + i)));
  const auto sx = hn::Add(hn::Mul(pixel, unit), hn::PromoteTo(dd, hn::Load(di, p.offset_x + i)));
  const auto sy =
      hn::Add(hn::Set(dd, at.y * double{sample_unit}), hn::PromoteTo(dd, hn::Load(di, p.offset_y + i)));
  Doubles e[3], g[3], g_dx[3], g_dy[3], m[3];
  for (int k = 0; k < 3; ++k) {
    const int from = (k + 1) % 3;
    e[k] =
        hn::Sub(hn::Mul(c.edge_x[k], hn::Sub(sy, c.y[from])), hn::Mul(c.edge_y[k], hn::Sub(sx, c.x[from])));
    g[k] = hn::Mul(e[k], c.q[k]);
    g_dx[k] = hn::Mul(hn::Mul(c.edge_y[k], hn::Neg(unit)), c.q[k]);
    g_dy[k] = hn::Mul(hn::Mul(c.edge_x[k], unit), c.q[k]);
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();
#endif

#endif
