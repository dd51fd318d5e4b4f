// Drawing one triangle into a part of a bin, pixels in lanes. Compiled once for each SIMD target.
#if defined(FRUSTUM_DRAW_TRIANGLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FRUSTUM_DRAW_TRIANGLE_INL
#undef FRUSTUM_DRAW_TRIANGLE_INL
#else
#define FRUSTUM_DRAW_TRIANGLE_INL
#endif

#include <hwy/highway.h>

#include "nodes/kernels/fill_triangles.h"
#include "nodes/kernels/simd/order-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Full = hn::ScalableTag<float>;
using Narrow = hn::CappedTag<float, 4>;

// Edge functions in 32-bit lanes. At pixel (i, j) from the middle of a bin, -32 <= i, j < 32, with e the
// function at its middle:
//   256 (a i + b j) + e >= 0  is  a i + b j + floor(e / 256) >= 0,
// for integers. |a| + |b| < 2^24 keeps |a i + b j| below 2^29, so that clamping floor(e / 256) to +-2^30
// changes no sign and no sum overflows.
constexpr int bin_radius = TriangleBins::size / 2;
constexpr std::int64_t lane_slope_limit = 1 << 24, lane_constant_limit = 1 << 30;
static_assert(bin_radius * lane_slope_limit <= lane_constant_limit / 2);
// Where the offsets of the samples differ from lane to lane, their products are taken in lanes, too:
//   256 (a i + b j + q) + r + floor((a x + b y + bias) / 16) >= 0  is
//   a i + b j + q + floor((a x + b y + bias + 16 r) / 4096) >= 0.
constexpr std::int64_t varying_slope_limit = 1 << 18;
static_assert(varying_slope_limit * sample_unit + 16 * 256 < (std::int64_t{1} << 31));

// One edge inside one bin, as above.
struct LaneEdge {
  std::int32_t a, b, c;
  std::int32_t r;  // bias + 16 r; used where samples vary
};

struct Drawing {
  std::array<LaneEdge, 3> edge;
  const DepthPlane<float>* depth;
  const SamplePositions* pattern;
  PlaneView<std::uint32_t> id;
  PlaneView<float> z;
  PixelRect rect, part;  // what is filled, and its part in one bin
  glm::ivec2 middle;     // of the bin
  std::uint32_t face;
  int sample;
};

std::int32_t lane_constant(std::int64_t c) {
  return static_cast<std::int32_t>(std::clamp(c, -lane_constant_limit, lane_constant_limit));
}

bool fits_lanes(const std::array<Edge, 3>& edges, std::int64_t limit) {
  return std::all_of(edges.begin(), edges.end(), [limit](const Edge& e) {
    return std::abs(std::int64_t{e.a}) + std::abs(std::int64_t{e.b}) < limit;
  });
}

// Whether every sample of the box lies inside all edges.
bool fills(const Drawing& t, const PixelRect& box) {
  return std::all_of(t.edge.begin(), t.edge.end(), [&](const LaneEdge& e) {
    const int x = (e.a < 0 ? box.x1 - 1 : box.x0) - t.middle.x;
    const int y = (e.b < 0 ? box.y1 - 1 : box.y0) - t.middle.y;
    return e.a * x + e.b * y + e.c >= 0;
  });
}

// Keeps the depths and the face in the lanes that are covered and strictly nearer than what is there.
template <class D, class V, class M>
HWY_INLINE void keep_nearest(D d, V depth, M covered, float* HWY_RESTRICT z, std::uint32_t* HWY_RESTRICT id,
                             std::uint32_t face) {
  const hn::RebindToUnsigned<D> du;
  const auto old = hn::LoadU(d, z);
  const auto nearer = hn::And(covered, hn::Lt(depth, old));
  if (hn::AllFalse(d, nearer)) return;
  hn::StoreU(hn::IfThenElse(nearer, depth, old), d, z);
  hn::StoreU(hn::IfThenElse(hn::RebindMask(du, nearer), hn::Set(du, face), hn::LoadU(du, id)), du, id);
}

template <class D, class V>
HWY_INLINE V within_corners(D d, const DepthPlane<float>& p, V depth) {
  const auto least = hn::Set(d, p.least), greatest = hn::Set(d, p.greatest);
  return held_between(depth, least, greatest);
}

// The sample lies at the same place in every pixel.
template <bool test_edges, class D>
HWY_INLINE void draw_fixed(D d, const Drawing& t, const PixelRect& box) {
  const hn::RebindToSigned<D> di;
  const int lanes = static_cast<int>(hn::Lanes(d)), last = t.part.x1 - lanes;
  const DepthPlane<float>& p = *t.depth;
  const std::int32_t ox = t.pattern->x[static_cast<std::size_t>(t.sample)];
  const std::int32_t oy = t.pattern->y[static_cast<std::size_t>(t.sample)];
  const auto iota = hn::Iota(di, 0);
  const auto iota_px = hn::ConvertTo(d, iota);
  const auto fraction = hn::Set(d, p.fraction_px(ox, p.anchor.x)), slope = hn::Set(d, p.dx);
  const auto a0 = hn::Mul(iota, hn::Set(di, t.edge[0].a)), a1 = hn::Mul(iota, hn::Set(di, t.edge[1].a)),
             a2 = hn::Mul(iota, hn::Set(di, t.edge[2].a));

  for (int y = box.y0; y < box.y1; ++y) {
    float* z = t.z.row(t.sample, y - t.rect.y0) - t.rect.x0;
    std::uint32_t* id = t.id.row(t.sample, y - t.rect.y0) - t.rect.x0;
    const float down = p.whole_px(y, p.anchor.y) + p.fraction_px(oy, p.anchor.y);
    const auto row_depth = hn::Set(d, p.z + p.dy * down);
    const int j = y - t.middle.y;
    for (int x = box.x0; x < box.x1; x += lanes) {
      const int at = std::min(x, last), i = at - t.middle.x;
      const auto side = [&](const LaneEdge& e, auto step) {
        return hn::Add(hn::Set(di, e.a * i + e.b * j + e.c), step);
      };
      // Without edges to test, only the lanes inside the box are known to be covered.
      auto covered = hn::RebindMask(
          d, hn::And(hn::Gt(iota, hn::Set(di, box.x0 - at - 1)), hn::Lt(iota, hn::Set(di, box.x1 - at))));
      if constexpr (test_edges) {
        const auto outside = hn::Or(hn::Or(side(t.edge[0], a0), side(t.edge[1], a1)), side(t.edge[2], a2));
        covered = hn::RebindMask(d, hn::Gt(outside, hn::Set(di, -1)));
        if (hn::AllFalse(d, covered)) continue;
      }
      const auto across = hn::Add(hn::Add(hn::Set(d, p.whole_px(at, p.anchor.x)), iota_px), fraction);
      const auto depth = within_corners(d, p, hn::Add(row_depth, hn::Mul(slope, across)));
      keep_nearest(d, depth, covered, z + at, id + at, t.face);
    }
  }
}

// The offsets of a sample in the pixels from (x, y) on.
template <class DI>
HWY_INLINE auto offsets(DI di, std::span<const std::uint16_t> of, const Drawing& t, int x, int y) {
  const hn::Rebind<std::uint16_t, DI> du16;
  const int period = t.pattern->period, lanes = static_cast<int>(hn::Lanes(di)), u = x & (period - 1);
  const std::uint16_t* row = &of[t.pattern->index(t.sample, 0, y)];
  if (u + lanes <= period) return hn::PromoteTo(di, hn::LoadU(du16, row + u));
  HWY_ALIGN std::uint16_t wrapped[hn::MaxLanes(Full())];
  for (int k = 0; k < lanes; ++k) wrapped[k] = row[(u + k) & (period - 1)];
  return hn::PromoteTo(di, hn::Load(du16, wrapped));
}

// The sample lies elsewhere in every pixel.
template <class D>
HWY_INLINE void draw_varying(D d, const Drawing& t, const PixelRect& box) {
  const hn::RebindToSigned<D> di;
  const int lanes = static_cast<int>(hn::Lanes(d)), last = t.part.x1 - lanes;
  const DepthPlane<float>& p = *t.depth;
  const auto iota = hn::Iota(di, 0);
  const auto iota_px = hn::ConvertTo(d, iota);
  const auto unit = hn::Set(d, 1.0f / sample_unit);
  const auto grid = [&](std::int32_t anchor) {  // the anchor's own offset in its pixel, 2^-12 px
    return hn::Set(di, (anchor & (corner_unit - 1)) * (sample_unit / corner_unit));
  };
  for (int y = box.y0; y < box.y1; ++y) {
    float* z = t.z.row(t.sample, y - t.rect.y0) - t.rect.x0;
    std::uint32_t* id = t.id.row(t.sample, y - t.rect.y0) - t.rect.x0;
    const int j = y - t.middle.y;
    for (int x = box.x0; x < box.x1; x += lanes) {
      const int at = std::min(x, last), i = at - t.middle.x;
      const auto ox = offsets(di, t.pattern->x, t, at, y), oy = offsets(di, t.pattern->y, t, at, y);
      const auto side = [&](const LaneEdge& e) {
        const auto a = hn::Set(di, e.a), b = hn::Set(di, e.b);
        const auto offset = hn::Add(hn::Add(hn::Mul(a, ox), hn::Mul(b, oy)), hn::Set(di, e.r));
        const auto pixel = hn::Add(hn::Set(di, e.a * i + e.b * j + e.c), hn::Mul(iota, a));
        return hn::Add(pixel, hn::ShiftRight<sample_bits>(offset));
      };
      const auto outside = hn::Or(hn::Or(side(t.edge[0]), side(t.edge[1])), side(t.edge[2]));
      const auto covered = hn::RebindMask(d, hn::Gt(outside, hn::Set(di, -1)));
      if (hn::AllFalse(d, covered)) continue;
      const auto fraction = [&](auto offset, std::int32_t anchor) {
        return hn::Mul(hn::ConvertTo(d, hn::Sub(offset, grid(anchor))), unit);
      };
      const auto across =
          hn::Add(hn::Add(hn::Set(d, p.whole_px(at, p.anchor.x)), iota_px), fraction(ox, p.anchor.x));
      const auto down = hn::Add(hn::Set(d, p.whole_px(y, p.anchor.y)), fraction(oy, p.anchor.y));
      const auto row_depth = hn::Add(hn::Set(d, p.z), hn::Mul(hn::Set(d, p.dy), down));
      const auto depth = within_corners(d, p, hn::Add(row_depth, hn::Mul(hn::Set(d, p.dx), across)));
      keep_nearest(d, depth, covered, z + at, id + at, t.face);
    }
  }
}

// The pixels of `box` whose sample at (ox, oy) lies in the triangle's bounding box.
HWY_INLINE PixelRect tightened(const PixelRect& box, const std::array<Edge, 3>& e, int ox, int oy) {
  constexpr std::int64_t scale = sample_unit / corner_unit;
  const auto first = [](std::int64_t least, int o) {
    return (least * scale - o + sample_unit - 1) >> sample_bits;
  };
  const auto end = [](std::int64_t greatest, int o) { return ((greatest * scale - o) >> sample_bits) + 1; };
  const auto [x0, x1] = std::minmax({e[0].start.x, e[1].start.x, e[2].start.x});
  const auto [y0, y1] = std::minmax({e[0].start.y, e[1].start.y, e[2].start.y});
  const auto raised = [](int v, std::int64_t to) { return static_cast<int>(std::max<std::int64_t>(v, to)); };
  const auto lowered = [](int v, std::int64_t to) { return static_cast<int>(std::min<std::int64_t>(v, to)); };
  return {raised(box.x0, first(x0, ox)), raised(box.y0, first(y0, oy)), lowered(box.x1, end(x1, ox)),
          lowered(box.y1, end(y1, oy))};
}

// Draws the current sample, which lies at the same place in every pixel, with lanes as wide as the box calls
// for.
HWY_INLINE void draw_fixed_box(const Drawing& t, const PixelRect& box) {
  if (box.empty()) return;
  const int wide = static_cast<int>(hn::Lanes(Full())), narrow = static_cast<int>(hn::Lanes(Narrow()));
  if (t.part.x1 - t.part.x0 < wide || box.x1 - box.x0 <= narrow) return draw_fixed<true>(Narrow(), t, box);
  const bool may_fill = box.x1 - box.x0 >= 8 && box.y1 - box.y0 >= 8;
  if (may_fill && fills(t, box))
    draw_fixed<false>(Full(), t, box);
  else
    draw_fixed<true>(Full(), t, box);
}

// One sample of any triangle that fits lanes.
void draw_fixed_sample(const ScreenTriangle<float>& t, Drawing& drawing, const PixelRect& box, int sample) {
  const std::int32_t ox = drawing.pattern->x[static_cast<std::size_t>(sample)];
  const std::int32_t oy = drawing.pattern->y[static_cast<std::size_t>(sample)];
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t e =
        t.edge[k].at_pixel(drawing.middle.x, drawing.middle.y) + t.edge[k].at_offset(ox, oy);
    drawing.edge[k] = {t.edge[k].a, t.edge[k].b, lane_constant(e >> corner_bits), 0};
  }
  drawing.depth = &t.depth;
  drawing.sample = sample;
  draw_fixed_box(drawing, tightened(box, t.edge, ox, oy));
}

// One sample of any triangle of the bin.
void draw_large(const FillScene<float>& scene, Drawing& drawing, const BinEntry& entry, int sample) {
  const PixelRect box = box_in(drawing.part, drawing.middle - bin_radius, entry);
  const ScreenTriangle<float> t = *screen_triangle(scene.mesh, entry.face, scene.sign());
  if (fits_lanes(t.edge, lane_slope_limit))
    draw_fixed_sample(t, drawing, box, sample);
  else
    draw_sample(t, entry.face, scene.pattern, sample, box, drawing.rect, drawing.id, drawing.z);
}

template <class D>
HWY_INLINE void draw_varying_samples(D d, const ScreenTriangle<float>& t, Drawing& drawing,
                                     const PixelRect& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int64_t e = t.edge[k].at_pixel(drawing.middle.x, drawing.middle.y);
    const auto r = static_cast<std::int32_t>(e & (corner_unit - 1));
    drawing.edge[k] = {t.edge[k].a, t.edge[k].b, lane_constant(e >> corner_bits),
                       t.edge[k].bias + r * (sample_unit / corner_unit)};
  }
  drawing.depth = &t.depth;
  for (drawing.sample = 0; drawing.sample < drawing.pattern->samples; ++drawing.sample)
    draw_varying(d, drawing, box);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();
#endif

#endif
