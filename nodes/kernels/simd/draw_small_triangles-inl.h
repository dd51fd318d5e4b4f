// Drawing many small triangles at once, triangles in lanes. Compiled once for each SIMD target.
#if defined(FRUSTUM_DRAW_SMALL_TRIANGLES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef FRUSTUM_DRAW_SMALL_TRIANGLES_INL
#undef FRUSTUM_DRAW_SMALL_TRIANGLES_INL
#else
#define FRUSTUM_DRAW_SMALL_TRIANGLES_INL
#endif

#include <hwy/highway.h>

#include "nodes/kernels/simd/draw_triangle-inl.h"

#if HWY_TARGET != HWY_SCALAR
HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
namespace {

// Corners are taken from the middle of the bin, in 2^-8 px. A triangle that touches the bin and is small lies
// within 32 + 64 px of it, so that a coordinate fits 16 bits, an edge function and its terms 2^14 (slope) *
// 1.5 * 2^14 (distance) * 2 < 2^30 fit 32, and (a x + b y + bias) <= 2 * 2^14 * 2^12 does.
constexpr int small_extent = 64 * corner_unit;
constexpr int key_bias = 1 << 15;
static_assert((bin_radius + 64) * corner_unit < key_bias);
// A small triangle whose box is at most 4 by 4 pixels is tiny: its pixels are slots, tested for all lanes at
// once.
constexpr int tiny_px = 4, slots = tiny_px * tiny_px;

using Float = Full;
using Int = hn::RebindToSigned<Float>;
using Uint = hn::RebindToUnsigned<Float>;
using Floats = hn::Vec<Float>;
using Ints = hn::Vec<Int>;
constexpr std::size_t max_lanes = hn::MaxLanes(Float());

HWY_INLINE Ints set(int v) { return hn::Set(Int(), v); }
HWY_INLINE Floats to_float(Ints v) { return hn::ConvertTo(Float(), v); }

HWY_INLINE hn::Mask<Int> at_most(Ints a, Ints b) { return hn::Not(hn::Gt(a, b)); }

struct LaneBox {
  Ints x0, y0, x1, y1;  // pixels from the middle of the bin, both ends included
};

struct LanePlane {
  Floats z, dx, dy, least, greatest;
  Ints anchor_x, anchor_y;
};

struct LaneTriangles {
  Ints a[3], b[3], e[3];  // edge functions and their values at the middle of the bin, 2^-16 px^2
  LanePlane depth;
  Ints x0, y0, x1, y1;  // bounding box of the corners
  hn::Mask<Int> small;
};

// Up to one vector of entries; the last one is repeated to fill it.
struct LaneEntries {
  hn::Vec<Uint> face;
  LaneBox box;
  hn::Mask<Int> active;  // its box has pixels of the part
};

LaneEntries load_entries(std::span<const BinEntry> entries, const Drawing& t) {
  HWY_ALIGN BinEntry padded[max_lanes];
  const std::size_t lanes = hn::Lanes(Uint());
  for (std::size_t k = 0; k < lanes; ++k) padded[k] = entries[std::min(k, entries.size() - 1)];
  hn::Vec<Uint> face, box;
  static_assert(sizeof(BinEntry) == 8);
  hn::LoadInterleaved2(Uint(), reinterpret_cast<const std::uint32_t*>(padded), face, box);
  const auto byte = [&](auto v) { return hn::BitCast(Int(), hn::And(v, hn::Set(Uint(), 255))); };
  const Ints r = set(bin_radius);
  const LaneBox all{hn::Sub(byte(box), r), hn::Sub(byte(hn::ShiftRight<8>(box)), r),
                    hn::Sub(byte(hn::ShiftRight<16>(box)), r), hn::Sub(byte(hn::ShiftRight<24>(box)), r)};
  const LaneBox cut{
      hn::Max(all.x0, set(t.part.x0 - t.middle.x)), hn::Max(all.y0, set(t.part.y0 - t.middle.y)),
      hn::Min(all.x1, set(t.part.x1 - 1 - t.middle.x)), hn::Min(all.y1, set(t.part.y1 - 1 - t.middle.y))};
  const auto filled = hn::And(at_most(cut.x0, cut.x1), at_most(cut.y0, cut.y1));
  return {face, cut, hn::And(filled, hn::FirstN(Int(), entries.size()))};
}

// (dz1 * leg2 - dz2 * leg1) * per_px in binary64, as DepthPlane has it.
HWY_INLINE Floats gradient(Floats z0, Floats z1, Floats z2, Ints leg1, Ints leg2, Ints area) {
  const hn::Half<Float> df;
  const hn::Half<Int> di;
  const hn::RepartitionToWide<Float> dd;
  const auto half = [&](auto z0h, auto z1h, auto z2h, auto leg1h, auto leg2h, auto areah) {
    const auto base = hn::PromoteTo(dd, z0h);
    const auto dz1 = hn::Sub(hn::PromoteTo(dd, z1h), base), dz2 = hn::Sub(hn::PromoteTo(dd, z2h), base);
    const auto per_px = hn::Div(hn::Set(dd, double{corner_unit}), hn::PromoteTo(dd, areah));
    const auto rise = hn::Sub(hn::Mul(dz1, hn::PromoteTo(dd, leg2h)), hn::Mul(dz2, hn::PromoteTo(dd, leg1h)));
    return hn::DemoteTo(df, hn::Mul(rise, per_px));
  };
  const auto low = half(hn::LowerHalf(df, z0), hn::LowerHalf(df, z1), hn::LowerHalf(df, z2),
                        hn::LowerHalf(di, leg1), hn::LowerHalf(di, leg2), hn::LowerHalf(di, area));
  const auto high = half(hn::UpperHalf(df, z0), hn::UpperHalf(df, z1), hn::UpperHalf(df, z2),
                         hn::UpperHalf(di, leg1), hn::UpperHalf(di, leg2), hn::UpperHalf(di, area));
  return hn::Combine(Float(), high, low);
}

// ScreenTriangle::make for a vector of triangles; lanes that are not small hold nothing of use.
LaneTriangles make_triangles(const ScreenMesh<float>& mesh, hn::Vec<Uint> face, glm::ivec2 middle,
                             float sign) {
  const auto* vertex_of = reinterpret_cast<const std::int32_t*>(mesh.face.data());
  const auto* number = reinterpret_cast<const float*>(mesh.position.data());
  const Ints first = hn::BitCast(Int(), hn::Add(hn::Add(face, face), face));
  const Floats scale = hn::Set(Float(), static_cast<float>(1 << mesh.corner_bits));
  const int shift = corner_bits - mesh.corner_bits;
  const auto snapped = [&](Ints index, int centre) {
    const Ints grid = hn::NearestInt(hn::Mul(hn::GatherIndex(Float(), number, index), scale));
    return hn::Sub(hn::ShiftLeftSame(grid, shift), set(centre * corner_unit));
  };
  Ints key[3];
  Floats z[3];
  LaneTriangles t;
  for (int k = 0; k < 3; ++k) {
    const Ints index = hn::ShiftLeft<2>(hn::GatherIndex(Int(), vertex_of, hn::Add(first, set(k))));
    const Ints x = snapped(index, middle.x), y = snapped(hn::Add(index, set(1)), middle.y);
    z[k] = hn::Mul(hn::GatherIndex(Float(), number, hn::Add(index, set(2))), hn::Set(Float(), sign));
    key[k] = hn::Or(hn::ShiftLeft<16>(y), hn::Add(x, set(key_bias)));
    t.x0 = k == 0 ? x : hn::Min(t.x0, x);
    t.x1 = k == 0 ? x : hn::Max(t.x1, x);
    t.y0 = k == 0 ? y : hn::Min(t.y0, y);
    t.y1 = k == 0 ? y : hn::Max(t.y1, y);
  }
  const Ints extent = hn::Max(hn::Sub(t.x1, t.x0), hn::Sub(t.y1, t.y0));
  t.small = at_most(extent, set(small_extent));

  const auto sort = [&](int i, int j) {
    const auto swap = hn::Gt(key[i], key[j]);
    const auto swap_z = hn::RebindMask(Float(), swap);
    const Ints least = hn::Min(key[i], key[j]);
    key[j] = hn::Max(key[i], key[j]);
    key[i] = least;
    const Floats zi = hn::IfThenElse(swap_z, z[j], z[i]);
    z[j] = hn::IfThenElse(swap_z, z[i], z[j]);
    z[i] = zi;
  };
  sort(0, 1), sort(1, 2), sort(0, 1);
  Ints x[3], y[3];
  for (int k = 0; k < 3; ++k) {
    x[k] = hn::Sub(hn::And(key[k], set(0xFFFF)), set(key_bias));
    y[k] = hn::ShiftRight<16>(key[k]);
  }
  const Ints x1 = hn::Sub(x[1], x[0]), y1 = hn::Sub(y[1], y[0]), x2 = hn::Sub(x[2], x[0]),
             y2 = hn::Sub(y[2], y[0]);
  const Ints area = hn::Sub(hn::Mul(x1, y2), hn::Mul(x2, y1));
  const auto turn =
      hn::Lt(area, hn::Zero(Int()));  // corners 0, 1, 2 turn from +y to +x: every edge the other way
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Ints a = hn::Sub(y[k], y[next]), b = hn::Sub(x[next], x[k]);
    t.a[k] = hn::IfThenElse(turn, hn::Neg(a), a);
    t.b[k] = hn::IfThenElse(turn, hn::Neg(b), b);
    t.e[k] = hn::Neg(hn::Add(hn::Mul(t.a[k], x[k]), hn::Mul(t.b[k], y[k])));
  }
  const auto lesser = [](Floats p, Floats q) { return hn::IfThenElse(hn::Lt(q, p), q, p); };
  const auto greater = [](Floats p, Floats q) { return hn::IfThenElse(hn::Lt(p, q), q, p); };
  t.depth = {z[0],
             gradient(z[0], z[1], z[2], y1, y2, area),
             gradient(z[0], z[2], z[1], x2, x1, area),
             lesser(lesser(z[0], z[1]), z[2]),
             greater(greater(z[0], z[1]), z[2]),
             x[0],
             y[0]};
  return t;
}

// The numbers of one vector of triangles, for the loop that draws them in turn.
struct StoredLanes {
  HWY_ALIGN std::int32_t a[3][max_lanes], b[3][max_lanes], c[3][max_lanes];
  HWY_ALIGN float z[max_lanes], dx[max_lanes], dy[max_lanes], least[max_lanes], greatest[max_lanes];
  HWY_ALIGN std::int32_t anchor_x[max_lanes], anchor_y[max_lanes];
  HWY_ALIGN std::int32_t x0[max_lanes], y0[max_lanes], x1[max_lanes], y1[max_lanes];
  HWY_ALIGN std::int32_t covered[max_lanes];  // a bit for each slot of a tiny triangle
  HWY_ALIGN float depth[slots][max_lanes];

  void keep(const LaneTriangles& t, glm::ivec2 middle) {
    for (int k = 0; k < 3; ++k) {
      hn::Store(t.a[k], Int(), a[k]);
      hn::Store(t.b[k], Int(), b[k]);
    }
    hn::Store(t.depth.z, Float(), z);
    hn::Store(t.depth.dx, Float(), dx);
    hn::Store(t.depth.dy, Float(), dy);
    hn::Store(t.depth.least, Float(), least);
    hn::Store(t.depth.greatest, Float(), greatest);
    hn::Store(hn::Add(t.depth.anchor_x, set(middle.x * corner_unit)), Int(), anchor_x);
    hn::Store(hn::Add(t.depth.anchor_y, set(middle.y * corner_unit)), Int(), anchor_y);
  }
  void keep(const LaneBox& box) {
    hn::Store(box.x0, Int(), x0);
    hn::Store(box.y0, Int(), y0);
    hn::Store(box.x1, Int(), x1);
    hn::Store(box.y1, Int(), y1);
  }
  DepthPlane<float> plane(std::size_t k) const {
    return {z[k], dx[k], dy[k], least[k], greatest[k], {anchor_x[k], anchor_y[k]}};
  }
};

// The pixels of `box` whose sample at (ox, oy) lies in the triangle's bounding box.
LaneBox tightened(const LaneBox& box, const LaneTriangles& t, int ox, int oy) {
  constexpr int scale = sample_bits - corner_bits;
  const auto first = [](Ints least, int o) {
    return hn::ShiftRight<sample_bits>(hn::Add(hn::ShiftLeft<scale>(least), set(sample_unit - 1 - o)));
  };
  const auto last = [](Ints greatest, int o) {
    return hn::ShiftRight<sample_bits>(hn::Sub(hn::ShiftLeft<scale>(greatest), set(o)));
  };
  return {hn::Max(box.x0, first(t.x0, ox)), hn::Max(box.y0, first(t.y0, oy)), hn::Min(box.x1, last(t.x1, ox)),
          hn::Min(box.y1, last(t.y1, oy))};
}

// Tests every slot of the tiny lanes and stores which are covered, and their depths.
void test_slots(const LaneTriangles& t, const LaneBox& box, const Ints (&c)[3], hn::Mask<Int> tiny, int ox,
                int oy, StoredLanes& out) {
  const Ints none = hn::Zero(Int());
  const Ints width = hn::IfThenElseZero(tiny, hn::Add(hn::Sub(box.x1, box.x0), set(1)));
  const Ints height = hn::IfThenElseZero(tiny, hn::Add(hn::Sub(box.y1, box.y0), set(1)));
  const int columns = hn::GetLane(hn::MaxOfLanes(Int(), width)),
            rows = hn::GetLane(hn::MaxOfLanes(Int(), height));
  const auto fraction = [](Ints anchor, int o) {
    const Ints grid = hn::And(anchor, set(corner_unit - 1));
    return hn::Mul(to_float(hn::Sub(set(o), hn::ShiftLeft<sample_bits - corner_bits>(grid))),
                   hn::Set(Float(), 1.0f / sample_unit));
  };
  const Floats fraction_x = fraction(t.depth.anchor_x, ox), fraction_y = fraction(t.depth.anchor_y, oy);
  const Ints whole_x = hn::Sub(box.x0, hn::ShiftRight<corner_bits>(t.depth.anchor_x));
  const Ints whole_y = hn::Sub(box.y0, hn::ShiftRight<corner_bits>(t.depth.anchor_y));
  Ints row[3], covered = none;
  for (int k = 0; k < 3; ++k)
    row[k] = hn::Add(c[k], hn::Add(hn::Mul(t.a[k], box.x0), hn::Mul(t.b[k], box.y0)));
  for (int j = 0; j < rows; ++j) {
    const auto in_rows = hn::Gt(height, set(j));
    const Floats down = hn::Add(to_float(hn::Add(whole_y, set(j))), fraction_y);
    const Floats row_depth = hn::Add(t.depth.z, hn::Mul(t.depth.dy, down));
    Ints side[3] = {row[0], row[1], row[2]};
    for (int i = 0; i < columns; ++i) {
      const auto inside = hn::Gt(hn::Or(hn::Or(side[0], side[1]), side[2]), set(-1));
      const auto hit = hn::And(hn::And(inside, in_rows), hn::Gt(width, set(i)));
      const int slot = j * tiny_px + i;
      covered = hn::Or(covered, hn::IfThenElseZero(hit, set(1 << slot)));
      const Floats across = hn::Add(to_float(hn::Add(whole_x, set(i))), fraction_x);
      const Floats depth = hn::Add(row_depth, hn::Mul(t.depth.dx, across));
      hn::Store(held_between(depth, t.depth.least, t.depth.greatest), Float(), out.depth[slot]);
      for (int k = 0; k < 3; ++k) side[k] = hn::Add(side[k], t.a[k]);
    }
    for (int k = 0; k < 3; ++k) row[k] = hn::Add(row[k], t.b[k]);
  }
  hn::Store(covered, Int(), out.covered);
}

HWY_INLINE void draw_slots(const StoredLanes& lanes, std::size_t k, const Drawing& t, std::uint32_t face) {
  const int x = t.middle.x + lanes.x0[k] - t.rect.x0, y = t.middle.y + lanes.y0[k] - t.rect.y0;
  float* z = t.z.row(t.sample, y) + x;
  std::uint32_t* id = t.id.row(t.sample, y) + x;
  for (auto left = static_cast<std::uint32_t>(lanes.covered[k]); left != 0; left &= left - 1) {
    const int slot = std::countr_zero(left), i = slot % tiny_px, j = slot / tiny_px;
    const float depth = lanes.depth[slot][k];
    if (!(depth < z[j * t.z.row_stride + i])) continue;
    z[j * t.z.row_stride + i] = depth;
    id[j * t.id.row_stride + i] = face;
  }
}

// Draws up to one vector of entries in turn; every pixel has the same samples.
void draw_entries(const FillScene<float>& scene, Drawing& drawing, std::span<const BinEntry> entries) {
  const LaneEntries in = load_entries(entries, drawing);
  if (hn::AllFalse(Int(), in.active)) return;
  const LaneTriangles t = make_triangles(scene.mesh, in.face, drawing.middle, scene.sign());
  StoredLanes lanes;
  lanes.keep(t, drawing.middle);

  HWY_ALIGN std::uint8_t bits[8] = {};
  const auto mask_bits = [&](hn::Mask<Int> m) {
    hn::StoreMaskBits(Int(), m, bits);
    return static_cast<std::uint32_t>(bits[0]) |
           (hn::Lanes(Int()) > 8 ? static_cast<std::uint32_t>(bits[1]) << 8 : 0);
  };
  const std::uint32_t small = mask_bits(t.small);
  for (int s = 0; s < scene.pattern.samples; ++s) {
    const std::int32_t ox = scene.pattern.x[static_cast<std::size_t>(s)],
                       oy = scene.pattern.y[static_cast<std::size_t>(s)];
    const LaneBox box = tightened(in.box, t, ox, oy);
    const auto filled = hn::And(at_most(box.x0, box.x1), at_most(box.y0, box.y1));
    const auto active = hn::And(in.active, hn::Or(filled, hn::Not(t.small)));
    const auto narrow = hn::Lt(hn::Max(hn::Sub(box.x1, box.x0), hn::Sub(box.y1, box.y0)), set(tiny_px));
    const auto tiny = hn::And(hn::And(active, t.small), narrow);
    Ints c[3];
    for (int k = 0; k < 3; ++k) {
      const auto top_left = hn::Or(hn::Gt(t.a[k], hn::Zero(Int())),
                                   hn::And(hn::Eq(t.a[k], hn::Zero(Int())), hn::Gt(t.b[k], hn::Zero(Int()))));
      const Ints bias = hn::IfThenZeroElse(top_left, set(-1));
      const Ints offset = hn::Add(hn::Add(hn::Mul(t.a[k], set(ox)), hn::Mul(t.b[k], set(oy))), bias);
      c[k] = hn::ShiftRight<corner_bits>(hn::Add(t.e[k], hn::ShiftRight<sample_bits - corner_bits>(offset)));
      hn::Store(c[k], Int(), lanes.c[k]);
    }
    lanes.keep(box);
    test_slots(t, box, c, tiny, ox, oy, lanes);
    drawing.sample = s;
    const std::uint32_t tiny_lanes = mask_bits(tiny);
    for (std::uint32_t left = mask_bits(active); left != 0; left &= left - 1) {
      const auto k = static_cast<std::size_t>(std::countr_zero(left));
      drawing.face = entries[k].face;
      if ((tiny_lanes >> k & 1) != 0) {
        draw_slots(lanes, k, drawing, entries[k].face);
      } else if ((small >> k & 1) != 0) {
        const DepthPlane<float> plane = lanes.plane(k);
        for (std::size_t e = 0; e < 3; ++e)
          drawing.edge[e] = {lanes.a[e][k], lanes.b[e][k], lanes.c[e][k], 0};
        drawing.depth = &plane;
        const glm::ivec2 m = drawing.middle;
        draw_fixed_box(drawing,
                       {m.x + lanes.x0[k], m.y + lanes.y0[k], m.x + lanes.x1[k] + 1, m.y + lanes.y1[k] + 1});
      } else {
        draw_large(scene, drawing, entries[k], s);
      }
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();
#endif

#endif
