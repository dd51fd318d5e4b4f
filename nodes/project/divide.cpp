#include "nodes/project/divide.h"

#include "nodes/project.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {};
struct Outputs {
  Ref<Mesh> mesh;
};

// Without the faces that have a corner where there is no point.
Mesh in_front(const Mesh& mesh, std::span<const std::uint8_t> no_point, Context& ctx) {
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
  return select_faces(mesh, faces);
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Clip = glm::vec<4, R>;
    using Ndc = glm::vec<3, R>;
    const auto clip = in.mesh->real<R>("position");
    auto ndc = Column::make<Ndc>("position", Domain::vertex, clip->rows(), Space::ndc);
    std::vector<std::uint8_t> no_point(clip->rows());
    const auto without =
        project::clip_to_ndc<R>(clip->template values<Clip>(), ndc->template values<Ndc>(), no_point);
    *out = in.mesh->with(std::move(ndc));
    if (without > 0) *out = in_front(*out, no_point, ctx);
  });
  ctx.count("vertices", out->vertices());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::project_divide() {
  return node("project.divide", run)
      .doc(
          "Divides by w: clip space to normalised device coordinates, where the view volume is the cube from "
          "-1 to 1.")
      .cite("Errata E12: only after clipping in homogeneous space")
      .covers(20)
      .input("mesh", &Inputs::mesh, "A clipped mesh in clip space.", {.space = Space::clip})
      .output("mesh", &Outputs::mesh,
              "Position in NDC; faces with a corner on or behind the eye's plane are dropped.",
              {.space = Space::ndc});
}

}  // namespace frustum
