#include "nodes/kernels/simd/interpolate_attributes.h"

#include <bit>
#include <cstring>
#include <vector>

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

// Calls visit(i) for the vectors of the stretch in which something is seen.
template <class Visit>
HWY_INLINE void each_seen(std::uint32_t seen, Visit&& visit) {
  for (; seen != 0; seen &= seen - 1) visit(std::countr_zero(seen) * static_cast<int>(hn::Lanes(Float())));
}

// Where the numbers of an attribute go: its planes at the first pixel of a row. Null: nobody reads them. Found once
// for a row, not for every vector of its points.
struct AttributeRow {
  float *value[4], *dx[4], *dy[4];
  bool slopes = false;

  static AttributeRow of(const Attribute<float>& a, int sample, int y) {
    const auto start = [&](const PlaneView<float>& plane) {
      return plane.data == nullptr ? nullptr : plane.row(sample, y);
    };
    AttributeRow row;
    for (std::size_t c = 0; c < 4; ++c) {
      row.value[c] = start(a.value[c]), row.dx[c] = start(a.dx[c]), row.dy[c] = start(a.dy[c]);
      row.slopes = row.slopes || row.dx[c] != nullptr || row.dy[c] != nullptr;
    }
    return row;
  }

  template <class Visit>
  void each_plane(const Visit& visit) const {
    for (float* const* planes : {value, dx, dy})
      for (std::size_t c = 0; c < 4; ++c)
        if (planes[c] != nullptr) visit(planes[c]);
  }
};

// The rows of all planes at one y of one sample.
struct Rows {
  float* w = nullptr;
  std::vector<AttributeRow> attributes;

  void begin(const AttributePlanes<float>& planes, int sample, int y) {
    w = planes.w.data == nullptr ? nullptr : planes.w.row(sample, y);
    attributes.clear();
    for (const Attribute<float>& a : planes.attributes) attributes.push_back(AttributeRow::of(a, sample, y));
  }
};

// Writes a vector of points to `to`, 0 in those that see nothing, and no point beyond the first `left`.
HWY_INLINE void put(float* to, int left, hn::Mask<Float> seen, Floats value) {
  if (to == nullptr) return;
  value = hn::IfThenElseZero(seen, value);
  if (HWY_LIKELY(left >= static_cast<int>(hn::Lanes(Float())))) return hn::StoreU(value, Float(), to);
  HWY_ALIGN float all[hn::MaxLanes(Float())];
  hn::Store(value, Float(), all);
  std::copy_n(all, left, to);
}

// An attribute over the points of a vector: the value at the corner of greatest weight, what the other two add
// to it, and the range of the three.
struct Corners {
  Floats first, ab, ac, least, greatest;
};

HWY_INLINE Corners corners_of(Floats a, Floats b, Floats c) {
  return {a, hn::Sub(b, a), hn::Sub(c, a), lesser(c, lesser(b, a)), greater(c, greater(b, a))};
}

HWY_INLINE bool one_base(const Points& p, int i) {
  const hn::RebindToSigned<Float> di;
  return hn::AllTrue(di, hn::Eq(hn::Load(di, p.base + i), hn::Set(di, p.base[i])));
}

// The rows of a column that the corners of a face have.
HWY_INLINE glm::uvec3 rows_of(const LaneFaces& faces, int f, AttributeDomain domain) {
  if (domain == AttributeDomain::vertex) return faces.vertex[f];
  if (domain == AttributeDomain::face) return glm::uvec3(faces.face[f]);
  const std::uint32_t first = 3 * faces.face[f];
  return {first, first + 1, first + 2};
}

// interpolate_attribute at the points of a stretch that see something.
//   x  of the stretch, in the row
template <int width, bool slopes>
void interpolate(const Attribute<float>& a, const AttributeRow& row, int x, int count, std::uint32_t seen_in,
                 Points& p) {
  each_seen(seen_in, [&](int i) HWY_ATTR {
    const Float df;
    const hn::RebindToSigned<Float> di;
    const LaneFaces& faces = p.faces_from(i);
    // With one base in all lanes the corners are turned, and no lane needs to pick.
    const bool turned = one_base(p, i);
    const int t = turned ? p.base[i] : 0, corner[3] = {t, t == 2 ? 0 : t + 1, t == 0 ? 2 : t - 1};
    Floats all[3][width];
    load_corners(faces, all, [&](int f, const float*(&from)[3]) HWY_ATTR {
      const glm::uvec3 rows = rows_of(faces, f, a.domain);
      for (int k = 0; k < 3; ++k) from[k] = a.data + std::size_t{width} * rows[corner[k]];
    });
    const auto base = hn::Load(di, p.base + i);
    const auto first = hn::RebindMask(df, hn::Eq(base, hn::Zero(di)));
    const auto second = hn::RebindMask(df, hn::Eq(base, hn::Set(di, 1)));
    const auto pick = [&](Floats of_first, Floats of_second, Floats of_third) HWY_ATTR {
      return hn::IfThenElse(first, of_first, hn::IfThenElse(second, of_second, of_third));
    };
    const hn::Mask<Float> seen = seen_from(p, i);
    const Floats u = hn::Load(df, p.u + i), v = hn::Load(df, p.v + i);
    const int at = x + i, left = count - i;
    const auto advanced = [at](float* to) { return to == nullptr ? to : to + at; };
    const auto slope = [&](float* to, const Corners& c, const float* du, const float* dv) HWY_ATTR {
      put(advanced(to), left, seen,
          hn::Add(hn::Mul(hn::Load(df, du + i), c.ab), hn::Mul(hn::Load(df, dv + i), c.ac)));
    };
    HWY_UNROLL(4)
    for (int c = 0; c < width; ++c) {
      const Floats of_a = all[0][c], of_b = all[1][c], of_c = all[2][c];
      const Corners corners =
          turned ? corners_of(of_a, of_b, of_c)
                 : corners_of(pick(of_a, of_b, of_c), pick(of_b, of_c, of_a), pick(of_c, of_a, of_b));
      const Floats value = hn::Add(hn::Add(corners.first, hn::Mul(u, corners.ab)), hn::Mul(v, corners.ac));
      put(advanced(row.value[c]), left, seen, held_between(value, corners.least, corners.greatest));
      if constexpr (slopes) {
        slope(row.dx[c], corners, p.u_dx, p.v_dx);
        slope(row.dy[c], corners, p.u_dy, p.v_dy);
      }
    }
  });
}

template <bool slopes>
void interpolate_any(const Attribute<float>& a, const AttributeRow& row, int x, int count, std::uint32_t seen,
                     Points& p) {
  switch (a.width) {
    case 1: return interpolate<1, slopes>(a, row, x, count, seen, p);
    case 2: return interpolate<2, slopes>(a, row, x, count, seen, p);
    case 3: return interpolate<3, slopes>(a, row, x, count, seen, p);
    default: return interpolate<4, slopes>(a, row, x, count, seen, p);
  }
}

// Fills points [begin, end) of a row, which see nothing.
void fill_empty(const Rows& rows, int begin, int end) {
  const Float df;
  const hn::CappedTag<float, 1> one;
  const int lanes = static_cast<int>(hn::Lanes(df));
  const auto clear = [&](float* row) {
    // Not std::fill: for so few numbers the compiler's `rep stos` costs more than all else here.
    int i = begin;
    for (; i + lanes <= end; i += lanes) hn::StoreU(hn::Zero(df), df, row + i);
    for (; i < end; ++i) hn::StoreU(hn::Zero(one), one, row + i);
  };
  if (rows.w != nullptr) clear(rows.w);
  for (const AttributeRow& row : rows.attributes) row.each_plane(clear);
}

// Loads the faces of a stretch; returns a bit for each vector of points that sees any.
HWY_INLINE std::uint32_t load_stretch(const std::uint32_t* ids, int count, Points& p) {
  const int lanes = static_cast<int>(hn::Lanes(Float()));
  std::uint32_t seen = 0;
  for (int i = 0; i < count; i += lanes)
    if (load_faces(ids, count, i, p)) seen |= 1u << (i / lanes);
  return seen;
}

// Fills a stretch from `x` of the row on, some of whose points see something.
void fill_stretch(const AttributeScene<float>& scene, std::span<const Attribute<float>> attributes,
                  bool differentiate, const Stretch& at, const Rows& rows, int x, std::uint32_t seen,
                  Points& p) {
  const int lanes = static_cast<int>(hn::Lanes(Float()));
  for (int i = 0; i < at.count; i += lanes)
    if ((seen >> (i / lanes) & 1) == 0) fill_empty(rows, x + i, x + std::min(i + lanes, at.count));
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
  if (rows.w != nullptr)
    each_seen(seen,
              [&](int i) { put(rows.w + x + i, at.count - i, seen_from(p, i), hn::Load(Float(), p.w + i)); });
  for (std::size_t i = 0; i < attributes.size(); ++i) {
    const AttributeRow& row = rows.attributes[i];
    if (row.slopes)
      interpolate_any<true>(attributes[i], row, x, at.count, seen, p);
    else
      interpolate_any<false>(attributes[i], row, x, at.count, seen, p);
  }
}

}  // namespace

void interpolate_attributes(const AttributeScene<float>& scene, PixelRect rect,
                            PlaneView<const std::uint32_t> id, const AttributePlanes<float>& planes) {
  const bool differentiate = std::any_of(planes.attributes.begin(), planes.attributes.end(),
                                         [](const Attribute<float>& a) { return a.differentiates(); });
  Points points{};
  points.face_of_edges = no_face;
  Rows rows;
  for (int s = 0; s < scene.pattern.samples; ++s) {
    const auto sample = static_cast<std::size_t>(s);
    std::fill_n(points.offset_x, stretch, std::int32_t{scene.pattern.x[sample]});
    std::fill_n(points.offset_y, stretch, std::int32_t{scene.pattern.y[sample]});
    for (int y = rect.y0; y < rect.y1; ++y) {
      const std::uint32_t* ids = id.row(s, y - rect.y0);
      const int width = rect.x1 - rect.x0;
      if (y + 1 < rect.y1) prefetch(scene, planes, ids + id.row_stride, width);
      rows.begin(planes, s, y - rect.y0);
      int empty = 0;  // from there to x nothing is seen, nor is it filled yet
      for (int x = 0; x < width; x += stretch) {
        const Stretch at{s, rect.x0 + x, y, std::min(stretch, width - x)};
        const std::uint32_t seen = load_stretch(ids + x, at.count, points);
        if (seen == 0) continue;
        if (empty < x) fill_empty(rows, empty, x);
        fill_stretch(scene, planes.attributes, differentiate, at, rows, x, seen, points);
        empty = x + at.count;
      }
      if (empty < width) fill_empty(rows, empty, width);
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
