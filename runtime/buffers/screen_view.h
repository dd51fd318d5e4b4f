// A mesh in screen space as the algorithms of visibility see it, and the planes that they fill.
#pragma once

#include "nodes/kernels/fill_triangles.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/tiled.h"

namespace frustum {

// The picture of the mesh's camera. Throws NodeError("no_camera") for a mesh that has passed no projection, and
// NodeError("too_large") above 65536 px.
Rect picture_window(const Mesh& mesh);
// The picture of a camera. Throws NodeError("too_large").
Rect picture_window(const Camera& camera);

inline kernels::PixelRect pixel_rect(Rect r) { return {r.x0, r.y0, r.x1, r.y1}; }

// The part of `rect` that some face of the bins may be seen in.
inline Rect seen_part(const kernels::TriangleBins& bins, Rect rect) {
  const kernels::PixelRect part = kernels::drawn_part(bins, pixel_rect(rect));
  return part.empty() ? Rect{} : Rect{part.x0, part.y0, part.x1, part.y1};
}

// The samples of a pattern, or the middle of the pixel where there is none.
kernels::SamplePositions sample_positions(const SamplePattern* pattern);

kernels::DepthOrder depth_order(const Mesh& mesh);

// Of the grid that corners on the screen snap to: 2^-bits px.
int corner_bits_of(const Mesh& mesh);

// The mesh's spans in one precision, and what owns them.
template <class R>
struct ScreenView {
  Ref<Mesh> mesh;
  Ref<Column> position;

  explicit ScreenView(Ref<Mesh> of) : mesh(std::move(of)), position(mesh->real<R>("position")) {}
  kernels::ScreenMesh<R> triangles() const {
    const Column* origin = mesh->find("origin");
    return {position->template values<glm::vec<4, R>>(), mesh->triangles(),
            origin != nullptr ? origin->values<std::uint32_t>() : std::span<const std::uint32_t>(),
            corner_bits_of(*mesh)};
  }
};

// Calls fill(rect, id, z) for the planes id and Z of a visibility tile and the plane Z of a depth tile; memory
// takes the place of planes that nobody reads, and the depths are copied where both tiles want them.
template <class R, class Fill>
void fill_visibility(const Tile& visibility, const Tile& depth, Arena& arena, const Fill& fill) {
  const Tile& shape = visibility.empty() ? depth : visibility;
  const Rect& r = shape.rect();
  const auto plane = [&]<class T>(const Tile& tile, int index, T*) -> kernels::PlaneView<T> {
    if (!tile.empty() && tile.has(index))
      return {tile.row<T>(index, 0, r.y0), tile.row_stride(), tile.sample_stride()};
    const std::ptrdiff_t row = padded_row(r.width()), sample = row * r.height();
    return {arena.take<T>(static_cast<std::size_t>(sample * shape.samples())).data(), row, sample};
  };
  const bool into_depth = visibility.empty() || !visibility.has(1);
  const auto z = plane(into_depth ? depth : visibility, into_depth ? 0 : 1, static_cast<R*>(nullptr));
  fill(pixel_rect(r), plane(visibility, 0, static_cast<std::uint32_t*>(nullptr)), z);
  if (into_depth || depth.empty() || !depth.has(0)) return;
  for (int s = 0; s < shape.samples(); ++s)
    for (int y = r.y0; y < r.y1; ++y) std::copy_n(z.row(s, y - r.y0), r.width(), depth.row<R>(0, s, y));
}

// The frames of both outputs: planes id and Z, and Z alone.
template <class R>
Frame visibility_frame(Rect window, const Ref<SamplePattern>& pattern) {
  return {window, pattern, {{"id", PlaneKind::u32}, {"Z", plane_kind_of<R>}}};
}
template <class R>
Frame depth_frame(Rect window, const Ref<SamplePattern>& pattern) {
  return {window, pattern, {{"Z", plane_kind_of<R>}}};
}

}  // namespace frustum
