#include "nodes/cull/backface.h"

#include "nodes/cull.h"
#include "runtime/buffers/mesh_faces.h"
#include "runtime/core/node_type.h"

#include <algorithm>

namespace frustum {
namespace {

enum class Side { back, front };
constexpr auto choices(Side) {
  return std::array{std::pair{Side::back, "back"}, std::pair{Side::front, "front"}};
}

enum class Rays { perspective, orthographic };
constexpr auto choices(Rays) {
  return std::array{std::pair{Rays::perspective, "perspective"},
                    std::pair{Rays::orthographic, "orthographic"}};
}

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<Material>> material;
};
struct Params {
  Side drop = Side::back;
  Rays projection = Rays::perspective;
};
struct Outputs {
  Ref<Mesh> mesh;
};

template <class R>
std::vector<std::uint32_t> showing(const Mesh& mesh, const Params& p) {
  using cull::Rows;
  // Where y of clip space points down, what turns to the left on the screen turns to the right there.
  const bool mirrored =
      (mesh.space() == Space::clip || mesh.space() == Space::ndc) && clip_space(mesh.camera.get()).y_down;
  const int wanted = (p.drop == Side::back) != mirrored ? 1 : -1;
  const auto faces = [&]<Rows rows, int width>() {
    using Point = glm::vec<width, R>;
    const auto column = mesh.real<R>("position");
    return cull::faces_showing<rows, Point>(wanted, column->template values<Point>(), mesh.triangles());
  };
  switch (mesh.space()) {
    case Space::clip: return faces.template operator()<Rows::clip, 4>();
    case Space::screen: return faces.template operator()<Rows::screen, 4>();
    case Space::ndc: return faces.template operator()<Rows::flat, 3>();
    default:
      if (p.projection == Rays::orthographic) return faces.template operator()<Rows::flat, 3>();
      return faces.template operator()<Rows::eye_perspective, 3>();
  }
}

// Which faces stay whatever side they show: those of two-sided materials. Empty where there are none.
std::vector<std::uint8_t> two_sided_faces(const Mesh& mesh) {
  if (!mesh.materials) return {};
  const auto& all = mesh.materials->materials;
  const auto two_sided = [](const Material& m) { return m.two_sided; };
  if (std::none_of(all.begin(), all.end(), two_sided)) return {};
  const Column* column = mesh.find("material");
  if (column == nullptr) return std::vector<std::uint8_t>(mesh.faces(), two_sided(all[0]) ? 1 : 0);
  const auto of = column->values<std::uint32_t>();
  std::vector<std::uint8_t> stays(mesh.faces());
  for (std::size_t f = 0; f < stays.size(); ++f)
    stays[f] = of[f] < all.size() && two_sided(all[of[f]]) ? 1 : 0;
  return stays;
}

// The graph asks for it; what that costs is said. Culling a closed solid is not exact either: a sample on its
// outline, where a front and a back face meet at one depth, may show either.
Verdict back_faces(const Inputs& in, const Params& p, const Context&) {
  Verdict v =
      off_user("the graph drops them; the mesh is not known to be closed: some may be seen through holes");
  if (in.mesh->closed == true)
    v.why = "the graph drops them; the mesh is closed, so each is behind a front face";
  if (p.drop == Side::front) v.why = "the graph drops the faces that are seen, for what is behind";
  v.items = in.mesh->faces();
  return v;
}

Outputs run(const Inputs& in, const Params& p, Context& ctx) {
  // Only by its own name: forced with everything else, it stays what the graph asks for.
  if (ctx.effects != nullptr && ctx.effects->forced.contains("back_faces")) return {in.mesh};
  if (in.material && (*in.material)->two_sided) return {in.mesh};
  std::vector<std::uint8_t> stays;
  if (!in.material) stays = two_sided_faces(*in.mesh);
  auto faces = ctx.real([&]<class R>() { return showing<R>(*in.mesh, p); });
  if (!stays.empty()) {
    for (const std::uint32_t f : faces) stays[f] = 1;
    faces = kernels::indices_where(stays.size(), [&](std::size_t f) { return stays[f] != 0; });
  }
  ctx.count("triangles_culled", in.mesh->faces() - faces.size());
  if (faces.size() == in.mesh->faces()) return {in.mesh};
  ctx.claim(bytes_of_faces(*in.mesh, faces.size()));
  return {std::make_shared<Mesh>(select_faces(*in.mesh, faces))};
}

}  // namespace

NodeType nodes::cull_backface() {
  return node("cull.backface", run)
      .doc(
          "Drops faces that turn their back to the camera, which closed solids never show; two-sided ones "
          "stay.")
      .cite("Sign by exact arithmetic: Shewchuk 1997; errata E23 and E24")
      .covers(38, 39)
      .input("mesh", &Inputs::mesh, "A mesh in eye, clip, normalised device or screen space.",
             {.space = {Space::eye, Space::clip, Space::ndc, Space::screen}})
      .input("material", &Inputs::material, "One material for everything, instead of the mesh's own.")
      .param("drop", &Params::drop, "Which side goes; edge-on faces go with either.")
      .param("projection", &Params::projection,
             "How the eye sees in eye space; other spaces know it already.")
      .shortcut(
          "back_faces", back_faces, "Faces that turn their back are carried on to be rasterized.",
          {"face", 100})  // of all; tests/bench/effects_bench.cpp, one thread, shared with others: 60 to 210
      .output("mesh", &Outputs::mesh,
              "The faces that show the other side or are two-sided; vertices are shared.");
}

}  // namespace frustum
