#include "nodes/cull/frustum.h"

#include "nodes/cull.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

struct Inputs {
  Ref<Mesh> mesh;
};
struct Params {};
struct Outputs {
  Ref<Mesh> mesh;
};

// Always licensed: clipping would drop the same faces, one by one.
Verdict outside(const Inputs& in, const Params&, const Context&) {
  return off_exact("a face that lies outside one side of the view volume covers no sample", in.mesh->faces());
}

Outputs run(const Inputs& in, const Params&, Context& ctx) {
  if (ctx.simulates("outside_faces")) return {in.mesh};
  const kernels::ClipSpace space = clip_space(in.mesh->camera.get());
  std::vector<std::uint32_t> faces;
  ctx.real([&]<class R>() {
    const auto column = in.mesh->real<R>("position");
    faces =
        cull::faces_not_outside<R>(space, column->template values<glm::vec<4, R>>(), in.mesh->triangles());
  });
  ctx.count("triangles_culled", in.mesh->faces() - faces.size());
  if (faces.size() == in.mesh->faces()) return {in.mesh};
  ctx.claim(bytes_of_faces(*in.mesh, faces.size()));
  return {std::make_shared<Mesh>(select_faces(*in.mesh, faces))};
}

}  // namespace

NodeType nodes::cull_frustum() {
  return node("cull.frustum", run)
      .doc("Drops faces that lie wholly outside one side of the view volume; what it keeps it does not cut.")
      .cite("Assarsson & Moller 2000, Journal of Graphics Tools 5(1), for triangles")
      .covers(37)
      .input("mesh", &Inputs::mesh, "A mesh in clip space.", {.space = Space::clip})
      .shortcut("outside_faces", outside, "Faces that lie wholly outside are carried on to clipping.",
                {"face", 0.1})  // tests/bench/effects_bench.cpp, one thread: what clipping does anyway
      .output("mesh", &Outputs::mesh, "The faces that may show; never one fewer than those that do.",
              {.space = Space::clip});
}

}  // namespace frustum
