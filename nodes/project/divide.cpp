#include "nodes/project/divide.h"

#include "nodes/project.h"
#include "runtime/buffers/mesh_positions.h"
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

Verdict divide(const Inputs& in, const Params&, const Context& ctx) {
  return ctx.real([&]<class R>() {
    const auto column = in.mesh->real<R>("position");
    const auto clip = column->template values<glm::vec<4, R>>();
    const std::size_t vertex = kernels::first_to_divide<R>(clip);
    if (vertex == clip.size())
      return off_exact("w is 1 at every vertex: the projection is parallel", clip.size());
    return on(fmt::format("w is {:.6g} at vertex {}", clip[vertex].w, vertex), clip.size());
  });
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  auto out = std::make_shared<Mesh>();
  ctx.real([&]<class R>() {
    using Clip = glm::vec<4, R>;
    using Ndc = glm::vec<3, R>;
    ctx.claim(in.mesh->vertices());
    std::vector<std::uint8_t> no_point(in.mesh->vertices());
    std::size_t without = 0;
    *out = with_positions<Clip, Ndc>(
        *in.mesh, Space::ndc, ctx, [&](std::span<const Clip> clip, std::span<Ndc> ndc) {
          without = project::clip_to_ndc<R>(ctx.simulates("perspective_divide"), clip, ndc, no_point);
        });
    if (without > 0) *out = without_unplaced(*out, no_point, ctx);
  });
  ctx.count("vertices", out->vertices());
  return {std::move(out)};
}

}  // namespace

NodeType nodes::project_divide() {
  return node("project.divide", run)
      .doc(
          "Divides by w: clip space to normalised device coordinates, where x and y of the view volume run "
          "from -1 to 1.")
      .cite("Errata E12: only after clipping in homogeneous space")
      .covers(20)
      .input("mesh", &Inputs::mesh, "A clipped mesh in clip space.", {.space = Space::clip})
      .effect("perspective_divide", divide, "Positions are divided by w.",
              {"vertex", 1})  // tests/bench/effects_bench.cpp, one thread: 0.5 to 1.1
      .output("mesh", &Outputs::mesh,
              "Position in NDC; faces with a corner on or behind the eye's plane are dropped.",
              {.space = Space::ndc});
}

}  // namespace frustum
