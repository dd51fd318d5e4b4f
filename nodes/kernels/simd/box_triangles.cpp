#include "nodes/kernels/simd/box_triangles.h"

#include <bit>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/box_triangles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::ScalableTag<float>;
using Int = hn::RebindToSigned<Float>;
using Uint = hn::RebindToUnsigned<Float>;
using Floats = hn::Vec<Float>;
using Ints = hn::Vec<Int>;
constexpr std::size_t max_lanes = hn::MaxLanes(Float());

// Lanes whose corners lie within this (px) of the origin, and whose legs are this long at most: a coordinate
// in samples' units is below 2^17 * 2^12 = 2^29, and the two products of the area below 2^15 * 2^15 (2^-8 px
// each).
constexpr double lane_limit_px = 1 << 17;
constexpr int lane_leg = (1 << 15) - 1;

HWY_INLINE Ints set(int v) { return hn::Set(Int(), v); }

struct LaneBoxes {
  Ints x0, y0, x1, y1;
  hn::Mask<Int> plain;  // lanes that the limits above hold for; the others are for the scalar twin
  hn::Mask<Int> flat, hit;
};

struct Corner {
  Ints x, y;
  hn::Mask<Float> in_range;
};

HWY_INLINE Corner load_corner(const ScreenMesh<float>& mesh, hn::Vec<Uint> vertex) {
  const Float df;
  const auto* number = reinterpret_cast<const float*>(mesh.position.data());
  const Ints at = hn::BitCast(Int(), hn::ShiftLeft<2>(vertex));
  const auto part = [&](int i) { return hn::GatherIndex(df, number + i, at); };
  const Floats x = part(0), y = part(1), z = part(2), w = part(3);
  const auto scale = hn::Set(df, static_cast<float>(1 << mesh.corner_bits));
  const auto grid = [&](Floats v) {
    return hn::ShiftLeftSame(hn::NearestInt(hn::Mul(v, scale)), corner_bits - mesh.corner_bits);
  };
  const auto within = [&](Floats v, double limit) {
    return hn::Le(hn::Abs(v), hn::Set(df, static_cast<float>(limit)));
  };
  const auto near = hn::And(within(x, lane_limit_px), within(y, lane_limit_px));
  const auto sane =
      hn::And(within(z, depth_limit), within(w, std::numeric_limits<float>::max()));  // false for NaN
  return {grid(x), grid(y), hn::And(near, sane)};
}

// box_triangle for the faces whose vertices are given.
HWY_INLINE LaneBoxes box_lanes(const ScreenMesh<float>& mesh, hn::Vec<Uint> a, hn::Vec<Uint> b,
                               hn::Vec<Uint> c, const SampleBox& samples, const PixelRect& window) {
  const Corner p = load_corner(mesh, a), q = load_corner(mesh, b), r = load_corner(mesh, c);
  const auto least = [](Ints u, Ints v, Ints w) { return hn::Min(hn::Min(u, v), w); };
  const auto greatest = [](Ints u, Ints v, Ints w) { return hn::Max(hn::Max(u, v), w); };
  const Ints left = least(p.x, q.x, r.x), right = greatest(p.x, q.x, r.x);
  const Ints top = least(p.y, q.y, r.y), bottom = greatest(p.y, q.y, r.y);
  const Ints leg = hn::Max(hn::Sub(right, left), hn::Sub(bottom, top));
  const auto in_range = hn::RebindMask(Int(), hn::And(hn::And(p.in_range, q.in_range), r.in_range));
  const Ints area =
      hn::Sub(hn::Mul(hn::Sub(q.x, p.x), hn::Sub(r.y, p.y)), hn::Mul(hn::Sub(r.x, p.x), hn::Sub(q.y, p.y)));

  constexpr int scale = sample_bits - corner_bits;
  const auto first = [](Ints v, int hi) {
    return hn::ShiftRight<sample_bits>(hn::Add(hn::ShiftLeft<scale>(v), set(sample_unit - 1 - hi)));
  };
  const auto last = [](Ints v, int lo) {
    return hn::ShiftRight<sample_bits>(hn::Sub(hn::ShiftLeft<scale>(v), set(lo)));
  };
  const Ints zero = hn::Zero(Int());
  LaneBoxes out;
  out.x0 = hn::Max(hn::Sub(first(left, samples.x1), set(window.x0)), zero);
  out.y0 = hn::Max(hn::Sub(first(top, samples.y1), set(window.y0)), zero);
  out.x1 = hn::Sub(hn::Min(last(right, samples.x0), set(window.x1 - 1)), set(window.x0));
  out.y1 = hn::Sub(hn::Min(last(bottom, samples.y0), set(window.y1 - 1)), set(window.y0));
  out.plain = hn::And(in_range, hn::Lt(leg, set(lane_leg)));
  out.flat = hn::Eq(area, zero);
  out.hit = hn::Not(hn::Or(hn::Gt(out.x0, out.x1), hn::Gt(out.y0, out.y1)));
  return out;
}

HWY_INLINE std::uint32_t bits_of(hn::Mask<Int> mask) {
  HWY_ALIGN std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(Int(), mask, bytes);
  return bytes[0] | static_cast<std::uint32_t>(hn::Lanes(Int()) > 8 ? bytes[1] << 8 : 0);
}

void write_lanes(const LaneBoxes& boxes, std::uint32_t face, std::uint32_t hits, BoxedTriangle* out,
                 BoxCounts& counts) {
  HWY_ALIGN std::int32_t x0[max_lanes], y0[max_lanes], x1[max_lanes], y1[max_lanes];
  hn::Store(boxes.x0, Int(), x0);
  hn::Store(boxes.y0, Int(), y0);
  hn::Store(boxes.x1, Int(), x1);
  hn::Store(boxes.y1, Int(), y1);
  const auto narrow = [](std::int32_t v) { return static_cast<std::uint16_t>(v); };
  for (; hits != 0; hits &= hits - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(hits));
    out[counts.boxed++] = {face + k, narrow(x0[k]), narrow(y0[k]), narrow(x1[k]), narrow(y1[k])};
  }
}

}  // namespace

BoxCounts box_triangles(const ScreenMesh<float>& mesh, std::uint32_t begin, std::uint32_t end,
                        const SampleBox& samples, const PixelRect& window, BoxedTriangle* out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(Uint()));
  const std::uint32_t all = (1u << lanes) - 1;
  if (mesh.position.size() >= std::size_t{1} << 29)
    return kernels::box_triangles(mesh, begin, end, samples, window, out);
  BoxCounts counts;
  std::uint32_t face = begin;
  for (; face + lanes <= end; face += lanes) {
    hn::Vec<Uint> a, b, c;
    hn::LoadInterleaved3(Uint(), &mesh.face[face].x, a, b, c);
    const LaneBoxes boxes = box_lanes(mesh, a, b, c, samples, window);
    const std::uint32_t plain = bits_of(boxes.plain), flat = bits_of(boxes.flat);
    if (plain == all) {
      counts.without_area += static_cast<std::uint64_t>(std::popcount(flat));
      write_lanes(boxes, face, bits_of(boxes.hit) & ~flat, out, counts);
    } else {
      for (std::uint32_t k = 0; k < lanes; ++k) box_triangle(mesh, face + k, samples, window, out, counts);
    }
  }
  for (; face < end; ++face) box_triangle(mesh, face, samples, window, out, counts);
  return counts;
}

#else  // without vectors the twin itself

BoxCounts box_triangles(const ScreenMesh<float>& mesh, std::uint32_t begin, std::uint32_t end,
                        const SampleBox& samples, const PixelRect& window, BoxedTriangle* out) {
  return kernels::box_triangles(mesh, begin, end, samples, window, out);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(box_triangles);

BoxCounts box_triangles(const ScreenMesh<float>& mesh, std::uint32_t begin, std::uint32_t end,
                        const SampleBox& samples, const PixelRect& window, BoxedTriangle* out) {
  return HWY_DYNAMIC_DISPATCH(box_triangles)(mesh, begin, end, samples, window, out);
}

}  // namespace frustum::kernels::simd
#endif
