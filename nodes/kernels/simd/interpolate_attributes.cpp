#include "nodes/kernels/simd/interpolate_attributes.h"

#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/interpolate_attributes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/attribute_points-inl.h"
#include "nodes/kernels/simd/order-inl.h"

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR
namespace {

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
void interpolate(const Attribute<float>& a, const Stretch& at, const PixelRect& rect, int i, Points& p) {
  const Float df;
  const LaneFaces& faces = p.faces_from(i);
  // With one base in all lanes the corners are turned, and no lane needs to pick.
  const bool turned = one_base(p, i);
  const int t = turned ? p.base[i] : 0, corner[3] = {t, (t + 1) % 3, (t + 2) % 3};
  Floats all[3][width];
  load_corners(faces, all, [&](int f, int k) {
    const glm::uvec3& vertex = faces.vertex[f];
    const std::size_t row = a.domain == AttributeDomain::vertex ? vertex[corner[k]]
                            : a.domain == AttributeDomain::corner
                                ? std::size_t{3} * faces.face[f] + static_cast<std::size_t>(corner[k])
                                : faces.face[f];
    return a.data + width * row;
  });
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
    find_faces(scene, i, p);
    load_offsets(scene.pattern, at, i, p);
  });
  each_seen(seen, [&](int i) {
    const auto weigh_halves = [&](const LaneEdges& lower, const LaneEdges& upper) HWY_ATTR {
      const int middle = i + static_cast<int>(hn::Lanes(Double()));
      if (differentiate) {
        weigh<true>(scene, lower, at, i, p);
        weigh<true>(scene, upper, at, middle, p);
      } else {
        weigh<false>(scene, lower, at, i, p);
        weigh<false>(scene, upper, at, middle, p);
      }
    };
    const LaneFaces& faces = p.faces_from(i);
    if (faces.count == 1) {
      load_edges(scene, faces.face[0], p);
      return weigh_halves(p.edges, p.edges);
    }
    const GridCorners corners(scene, faces);
    LaneEdges lower, upper;
    corners.edges_of_half<false>(scene.interpolation, lower);
    corners.edges_of_half<true>(scene.interpolation, upper);
    weigh_halves(lower, upper);
  });
  each_seen(seen, [&](int i) { put(planes.w, at, rect, i, seen_from(p, i), hn::Load(Float(), p.w + i)); });
  for (const Attribute<float>& a : planes.attributes)
    each_seen(seen, [&](int i) {
      if (a.width == 1)
        interpolate<1>(a, at, rect, i, p);
      else if (a.width == 2)
        interpolate<2>(a, at, rect, i, p);
      else if (a.width == 3)
        interpolate<3>(a, at, rect, i, p);
      else
        interpolate<4>(a, at, rect, i, p);
    });
}

}  // namespace

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes) {
  const bool differentiate = std::any_of(planes.attributes.begin(), planes.attributes.end(),
                                         [](const Attribute<float>& a) { return a.differentiates(); });
  Points points{};
  points.face_of_edges = no_face;
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
