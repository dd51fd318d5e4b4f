#include "runtime/buffers/mesh_positions.h"

#include "nodes/kernels/parallel.h"
#include "runtime/buffers/mesh_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace frustum {
namespace {

// Where vertices that are not equally far have one depth, the order of faces decides who is seen: the near plane is too
// near for the precision. Looks at 1024 vertices.
template <class R>
void warn_of_one_depth(std::span<const glm::vec<4, R>> clip, const Camera& camera, Context& ctx) {
  const std::size_t step = std::max<std::size_t>(1, clip.size() / 1024);
  const glm::vec<4, R>*nearest = nullptr, *farthest = nullptr;
  for (std::size_t i = 0; i < clip.size(); i += step) {
    const glm::vec<4, R>& p = clip[i];
    if (!(p.w > 0 && std::isfinite(p.w) && std::isfinite(p.z))) continue;
    if (nearest == nullptr || p.w < nearest->w) nearest = &p;
    if (farthest == nullptr || p.w > farthest->w) farthest = &p;
  }
  if (nearest == nullptr || farthest->w <= nearest->w * R(1.001)) return;
  const R depth = kernels::divided(*nearest).z;
  if (kernels::divided(*farthest).z != depth) return;
  ctx.warn(
      "one_depth",
      fmt::format("vertices {:.6g} and {:.6g} away have the same depth in {} precision, so that the order of "
                  "faces decides who is seen: near, which is {:.3g}, must be larger",
                  nearest->w, farthest->w, sizeof(R) == 4 ? "single" : "double", camera.near_z));
}

}  // namespace

Ref<Mesh> in_clip_space(const Mesh& mesh, const Ref<Camera>& camera, const kernels::Projection& volume,
                        Context& ctx) {
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Eye = glm::vec<3, R>;
    using Clip = glm::vec<4, R>;
    *out = with_positions<Eye, Clip>(
        mesh, Space::clip, ctx,
        [&](std::span<const Eye> eye, std::span<Clip> clip) { kernels::map_to_clip<R>(volume, eye, clip); });
    if (!volume.perspective) return;
    const auto column = out->template real<R>("position");
    warn_of_one_depth<R>(column->template values<Clip>(), *camera, ctx);
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
