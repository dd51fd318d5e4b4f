// Which triangle is nearest at every sample of a rectangle.
#pragma once

#include <cstddef>
#include <limits>

#include "nodes/kernels/bin_triangles.h"

namespace frustum::kernels {

// A plane of numbers of a rectangle: samples x rows x pixels. Strides count elements.
template <class T>
struct PlaneView {
  T* data;  // sample 0 of the rectangle's top left pixel
  std::ptrdiff_t row_stride, sample_stride;

  T* row(int sample, int y) const { return data + sample * sample_stride + y * row_stride; }
};

// How depths compare. Standard: the least is the nearest and nothing lies at 1. Reversed: the greatest, and
// 0.
enum class DepthOrder { standard, reversed };

// What fill_triangles reads.
template <std::floating_point R>
struct FillScene {
  ScreenMesh<R> mesh;
  SamplePositions pattern;
  const TriangleBins* bins;  // of this mesh and pattern
  DepthOrder order = DepthOrder::standard;

  R sign() const { return order == DepthOrder::standard ? R(1) : R(-1); }
  R far() const { return order == DepthOrder::standard ? R(1) : R(0); }
};

// Fills `id` and `z` with the nearest face at every sample of `rect`, or no_face and the far depth.
//   rect  absolute pixels within the window of the bins; any size and alignment
// Nearest is the least of (depth, origin, face). A pure function of (x, y, sample): the bytes do not depend
// on rect. Coverage is exact; see Edge and DepthPlane. Cost: O(entries of the touched bins + pixels of their
// boxes * samples). This is the truth that simd/fill_triangles.h is held against.
template <std::floating_point R>
void fill_triangles(const FillScene<R>& scene, PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z);

// Calls visit(part, corner, entries) for the parts of `rect` that lie in one bin each; `corner` is the bin's
// top left pixel.
template <class Visit>
void each_bin_of(const TriangleBins& bins, PixelRect rect, Visit&& visit) {
  constexpr int size = TriangleBins::size;
  const int left = bins.window.x0, top = bins.window.y0;
  for (int row = (rect.y0 - top) / size; row * size + top < rect.y1; ++row)
    for (int column = (rect.x0 - left) / size; column * size + left < rect.x1; ++column) {
      const int x = left + column * size, y = top + row * size;
      visit(intersection(rect, {x, y, x + size, y + size}), glm::ivec2(x, y), bins.bin(column, row));
    }
}

// The pixels of `part` that the box of an entry touches.
inline PixelRect box_in(PixelRect part, glm::ivec2 corner, const BinEntry& e) {
  return intersection(part, {corner.x + e.x0, corner.y + e.y0, corner.x + e.x1 + 1, corner.y + e.y1 + 1});
}

// The pixels of `rect` outside of which no triangle has its box; some may be covered by none. Empty where all of it is.
// Cost: O(entries of the touched bins), less where they fill them.
inline PixelRect drawn_part(const TriangleBins& bins, PixelRect rect) {
  PixelRect all{rect.x1, rect.y1, rect.x0, rect.y0};
  each_bin_of(bins, rect, [&](PixelRect part, glm::ivec2 corner, std::span<const BinEntry> entries) {
    constexpr std::size_t stride = 64;  // of entries between two looks at whether the part is full
    PixelRect box{255, 255, -1, -1};
    const auto within = [&] {
      return intersection(
          part, {corner.x + box.x0, corner.y + box.y0, corner.x + box.x1 + 1, corner.y + box.y1 + 1});
    };
    for (std::size_t i = 0; i < entries.size() && within() != part; i += stride)
      for (const BinEntry& e : entries.subspan(i, std::min(stride, entries.size() - i))) {
        box.x0 = std::min(box.x0, int{e.x0}), box.y0 = std::min(box.y0, int{e.y0});
        box.x1 = std::max(box.x1, int{e.x1}), box.y1 = std::max(box.y1, int{e.y1});
      }
    const PixelRect found = within();
    if (found.empty()) return;
    all = {std::min(all.x0, found.x0), std::min(all.y0, found.y0), std::max(all.x1, found.x1),
           std::max(all.y1, found.y1)};
  });
  return all;
}

// Draws one sample of a triangle into the pixels of `box`: keeps it where it is covered and strictly nearer
// than what is there.
template <std::floating_point R>
void draw_sample(const ScreenTriangle<R>& t, std::uint32_t face, const SamplePositions& pattern, int sample,
                 PixelRect box, PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z) {
  for (int y = box.y0; y < box.y1; ++y) {
    std::uint32_t* id_row = id.row(sample, y - rect.y0) - rect.x0;
    R* z_row = z.row(sample, y - rect.y0) - rect.x0;
    for (int x = box.x0; x < box.x1; ++x) {
      const std::size_t i = pattern.index(sample, x, y);
      const std::int32_t ox = pattern.x[i], oy = pattern.y[i];
      const auto inside = [&](const Edge& e) { return Edge::covers(e.at_pixel(x, y), e.at_offset(ox, oy)); };
      if (!inside(t.edge[0]) || !inside(t.edge[1]) || !inside(t.edge[2])) continue;
      const R depth = t.depth.at(x, y, ox, oy);
      if (!(depth < z_row[x])) continue;
      z_row[x] = depth;
      id_row[x] = face;
    }
  }
}

// Draws all samples of a triangle.
template <std::floating_point R>
void draw_triangle(const ScreenTriangle<R>& t, std::uint32_t face, const SamplePositions& pattern,
                   PixelRect box, PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z) {
  for (int s = 0; s < pattern.samples; ++s) draw_sample(t, face, pattern, s, box, rect, id, z);
}

template <std::floating_point R>
void fill_triangles(const FillScene<R>& scene, PixelRect rect, PlaneView<std::uint32_t> id, PlaneView<R> z) {
  const int width = rect.x1 - rect.x0, height = rect.y1 - rect.y0;
  for (int s = 0; s < scene.pattern.samples; ++s)
    for (int y = 0; y < height; ++y) {
      std::fill_n(id.row(s, y), width, no_face);
      std::fill_n(z.row(s, y), width, std::numeric_limits<R>::infinity());
    }
  // Entries come in ascending (origin, face), so the first drawn of equal depths is the one to keep.
  each_bin_of(*scene.bins, rect, [&](PixelRect part, glm::ivec2 corner, std::span<const BinEntry> entries) {
    for (const BinEntry& e : entries) {
      const PixelRect box = box_in(part, corner, e);
      if (box.empty()) continue;
      draw_triangle(*screen_triangle(scene.mesh, e.face, scene.sign()), e.face, scene.pattern, box, rect, id,
                    z);
    }
  });
  for (int s = 0; s < scene.pattern.samples; ++s)
    for (int y = 0; y < height; ++y) {
      const std::uint32_t* id_row = id.row(s, y);
      R* z_row = z.row(s, y);
      for (int x = 0; x < width; ++x) z_row[x] = id_row[x] == no_face ? scene.far() : scene.sign() * z_row[x];
    }
}

}  // namespace frustum::kernels
