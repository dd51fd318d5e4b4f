#include "runtime/buffers/mesh_positions.h"

#include "nodes/kernels/parallel.h"
#include "runtime/buffers/mesh_faces.h"

#include <fmt/format.h>

namespace frustum {

Ref<Mesh> in_clip_space(const Mesh& mesh, const Ref<Camera>& camera, const kernels::Projection& volume,
                        Context& ctx) {
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Eye = glm::vec<3, R>;
    using Clip = glm::vec<4, R>;
    *out = with_positions<Eye, Clip>(
        mesh, Space::clip, ctx,
        [&](std::span<const Eye> eye, std::span<Clip> clip) { kernels::map_to_clip<R>(volume, eye, clip); });
  });
  out->camera = camera;
  ctx.count("vertices", out->vertices());
  return out;
}

Mesh without_unplaced(const Mesh& mesh, std::span<const std::uint8_t> no_point, Context& ctx) {
  const auto triangles = mesh.triangles();
  const auto faces = kernels::indices_where(triangles.size(), [&](std::size_t f) {
    const auto& t = triangles[f];
    return (no_point[t.x] | no_point[t.y] | no_point[t.z]) == 0;
  });
  if (const auto dropped = triangles.size() - faces.size(); dropped > 0)
    ctx.warn("faces_behind_the_eye",
             fmt::format("{} faces were dropped: a corner has w <= 0 or is not finite; "
                         "clip.homogeneous before this node keeps their visible part",
                         dropped));
  ctx.claim(bytes_of_faces(mesh, faces.size()));
  return select_faces(mesh, faces);
}

}  // namespace frustum
