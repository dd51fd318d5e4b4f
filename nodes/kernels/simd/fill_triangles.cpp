#include "nodes/kernels/simd/fill_triangles.h"

#include <hwy/cache_control.h>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "nodes/kernels/simd/fill_triangles.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "nodes/kernels/simd/draw_small_triangles-inl.h"
#include "nodes/kernels/simd/draw_triangle-inl.h"

HWY_BEFORE_NAMESPACE();
namespace frustum::kernels::simd {
namespace HWY_NAMESPACE {
#if HWY_TARGET != HWY_SCALAR
namespace {

// Draws the entries of one bin into the part of the rectangle that lies in it.
void draw_part(const FillScene<float>& scene, Drawing drawing, std::span<const BinEntry> entries) {
  const int width = drawing.part.x1 - drawing.part.x0;
  const std::size_t wide = hn::Lanes(Full()), narrow = hn::Lanes(Narrow());
  const bool lanes_fit = width >= static_cast<int>(narrow);
  if (lanes_fit && scene.pattern.period == 1) {
    const auto batch = [&](std::size_t i) {
      return entries.subspan(std::min(i, entries.size()),
                             std::min(wide, entries.size() - std::min(i, entries.size())));
    };
    for (std::size_t i = 0; i < entries.size(); i += wide) {
      // Faces and corners lie anywhere in memory: ask for those of the next batches before this one is drawn.
      for (const BinEntry& e : batch(i + 2 * wide)) hwy::Prefetch(&scene.mesh.face[e.face]);
      for (const BinEntry& e : batch(i + wide))
        for (int k = 0; k < 3; ++k) hwy::Prefetch(&scene.mesh.position[scene.mesh.face[e.face][k]]);
      draw_entries(scene, drawing, batch(i));
    }
    return;
  }
  for (const BinEntry& entry : entries) {
    const PixelRect box = box_in(drawing.part, drawing.middle - bin_radius, entry);
    if (box.empty()) continue;
    const ScreenTriangle<float> t = *screen_triangle(scene.mesh, entry.face, scene.sign());
    drawing.face = entry.face;
    if (!lanes_fit || scene.pattern.period == 1 || !fits_lanes(t.edge, varying_slope_limit))
      draw_triangle(t, entry.face, scene.pattern, box, drawing.rect, drawing.id, drawing.z);
    else if (width >= static_cast<int>(wide) && box.x1 - box.x0 > static_cast<int>(narrow))
      draw_varying_samples(Full(), t, drawing, box);
    else
      draw_varying_samples(Narrow(), t, drawing, box);
  }
}

template <class F>
HWY_INLINE void each_vector(int width, F&& f) {
  const int lanes = static_cast<int>(hn::Lanes(Full()));
  int x = 0;
  for (; x + lanes <= width; x += lanes) f(Full(), x);
  for (; x < width; ++x) f(hn::CappedTag<float, 1>(), x);
}

void clear(std::uint32_t* HWY_RESTRICT id, float* HWY_RESTRICT z, int width, float depth) {
  each_vector(width, [=](auto d, int x) {
    const hn::RebindToUnsigned<decltype(d)> du;
    hn::StoreU(hn::Set(du, no_face), du, id + x);
    hn::StoreU(hn::Set(d, depth), d, z + x);
  });
}

void finish(const std::uint32_t* HWY_RESTRICT id, float* HWY_RESTRICT z, int width, float sign, float far) {
  each_vector(width, [=](auto d, int x) {
    const hn::RebindToUnsigned<decltype(d)> du;
    const auto empty = hn::RebindMask(d, hn::Eq(hn::LoadU(du, id + x), hn::Set(du, no_face)));
    const auto depth = hn::Mul(hn::Set(d, sign), hn::LoadU(d, z + x));
    hn::StoreU(hn::IfThenElse(empty, hn::Set(d, far), depth), d, z + x);
  });
}

void fill(const FillScene<float>& scene, PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<float> z) {
  // Each bin is cleared, drawn and finished before the next, so that it stays in the first caches.
  each_bin_of(*scene.bins, rect, [&](PixelRect part, glm::ivec2 corner, std::span<const BinEntry> entries) {
    const int x = part.x0 - rect.x0, width = part.x1 - part.x0;
    const auto each_row = [&](auto&& visit) HWY_ATTR {
      for (int s = 0; s < scene.pattern.samples; ++s)
        for (int y = part.y0 - rect.y0; y < part.y1 - rect.y0; ++y) visit(id.row(s, y) + x, z.row(s, y) + x);
    };
    const float least = entries.empty() ? scene.far() : std::numeric_limits<float>::infinity();
    each_row([&](std::uint32_t* i, float* depth) HWY_ATTR { clear(i, depth, width, least); });
    if (entries.empty()) return;
    draw_part(scene, {{}, nullptr, &scene.pattern, id, z, rect, part, corner + bin_radius, 0, 0}, entries);
    each_row([&](std::uint32_t* i, float* depth)
                 HWY_ATTR { finish(i, depth, width, scene.sign(), scene.far()); });
  });
}

}  // namespace

void fill_triangles(const FillScene<float>& scene, PixelRect rect, PlaneView<std::uint32_t> id,
                    PlaneView<float> z) {
  fill(scene, rect, id, z);
}

#else  // without vectors the twin itself

void fill_triangles(const FillScene<float>& scene, PixelRect rect, PlaneView<std::uint32_t> id,
                    PlaneView<float> z) {
  kernels::fill_triangles<float>(scene, rect, id, z);
}

#endif
}  // namespace HWY_NAMESPACE
}  // namespace frustum::kernels::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace frustum::kernels::simd {

HWY_EXPORT(fill_triangles);

void fill_triangles(const FillScene<float>& scene, PixelRect rect, PlaneView<std::uint32_t> id,
                    PlaneView<float> z) {
  HWY_DYNAMIC_DISPATCH(fill_triangles)(scene, rect, id, z);
}

}  // namespace frustum::kernels::simd
#endif
