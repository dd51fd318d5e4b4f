#include "nodes/visibility/zbuffer.h"

#include "nodes/visibility.h"
#include "runtime/buffers/face_finder.h"

#include <fmt/format.h>

namespace frustum {
namespace zbuffer {
constexpr auto choices(Format) {
  return std::array{std::pair{Format::unorm16, "unorm16"}, std::pair{Format::unorm24, "unorm24"},
                    std::pair{Format::unorm32, "unorm32"}, std::pair{Format::float32, "float32"},
                    std::pair{Format::real, "real"}};
}
constexpr auto choices(Interpolation) {
  return std::array{std::pair{Interpolation::edges, "edges"}, std::pair{Interpolation::plane, "plane"}};
}
}  // namespace zbuffer
namespace {

struct Inputs {
  Ref<Mesh> mesh;
  std::optional<Ref<SamplePattern>> pattern;
};
struct Params {
  zbuffer::Format format = zbuffer::Format::unorm24;
  zbuffer::Interpolation interpolation = zbuffer::Interpolation::plane;
  double bias_constant = 0, bias_slope = 0, bias_clamp = 0;
  std::vector<std::string> bias_materials;
};
struct Outputs {
  Tiled<Visibility> visibility;
  Tiled<Depth> depth;
};

using State = FaceFinders<zbuffer::DepthBuffer<float>, zbuffer::DepthBuffer<double>>;

// Marks the faces made of one of these materials; empty where none is named, which means all.
std::vector<std::uint8_t> faces_made_of(const Mesh& mesh, const std::vector<std::string>& names,
                                        Context& ctx) {
  if (names.empty()) return {};
  const std::vector<Material> none;
  const auto& all = mesh.materials ? mesh.materials->materials : none;
  std::vector<std::uint8_t> chosen(all.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    bool known = false;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k].name == names[i]) chosen[k] = 1, known = true;
    if (!known)
      throw NodeError("unknown_material", fmt::format("the mesh has no material '{}'", names[i]),
                      at_param(fmt::format("bias_materials/{}", i)));
  }
  ctx.claim(mesh.faces());
  std::vector<std::uint8_t> marks(mesh.faces(), chosen[0]);
  if (const Column* column = mesh.find("material")) {
    const auto of = column->values<std::uint32_t>();
    for (std::size_t f = 0; f < marks.size(); ++f) marks[f] = of[f] < chosen.size() ? chosen[of[f]] : 0;
  }
  return marks;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  return prepare_finder<State, Outputs>(in, ctx, [&]<class R>(const FinderScene<R>& s) {
    zbuffer::DepthBuffer<R> buffer(s.mesh, s.pattern, s.window, clip_space(in.mesh->camera.get()).depth,
                                   p.format, p.interpolation, s.claim);
    buffer.set_bias({p.bias_constant, p.bias_slope, p.bias_clamp},
                    faces_made_of(*in.mesh, p.bias_materials, ctx));
    ctx.count("triangle_bin_pairs", buffer.bins().entries.size());
    return buffer;
  });
}

void tile(const State& state, const TilesOf<Inputs>&, const TilesOf<Outputs>& out, Arena& arena) {
  fill_faces(state, out, arena);
}

}  // namespace

NodeType nodes::visibility_zbuffer() {
  return pixel_node("visibility.zbuffer", prepare, tile)
      .doc("Finds the nearest face at every sample with a depth buffer of few bits, to show what they hide.")
      .cite(
          "Catmull 1974, A Subdivision Algorithm for Computer Display of Curved Surfaces (the depth buffer)")
      .cite("Upchurch & Desbrun 2012, Tightening the Precision of Perspective Rendering, JGT 16:40")
      .cite(
          "Vulkan 1.3, Depth Bias; OpenGL 4.6 core profile, 14.6.5 Depth Offset; Direct3D 11.3, 15.10 Depth "
          "Bias")
      .covers(40, 41)
      .input("mesh", &Inputs::mesh, "Opaque triangles of either winding, as rasterize.triangles takes them.",
             {.space = Space::screen})
      .input("pattern", &Inputs::pattern, "Where a pixel's samples lie; left out: one sample in its middle.")
      .param("format", &Params::format,
             "In what a depth is kept: whole numbers of 16, 24 or 32 bits, or reals; fewer bits make faces "
             "fight.")
      .knob({"unorm16", "unorm24", "unorm32", "real"},
            "Depths closer than half a step are one, and the lowest source wins.")
      .param(
          "interpolation", &Params::interpolation,
          "Depth from the plane of the corners, or along two sides and then between them, which rounds more.")
      .knob({"edges", "plane"}, "Three interpolations round more than one plane.")
      .param("bias_constant", &Params::bias_constant,
             "Added to depth in the least steps that the format keeps apart; raising it adds more.",
             {.unit = "steps"})
      .param("bias_slope", &Params::bias_slope,
             "Added in changes of a face's own depth over a pixel; raising it adds more to faces seen at a "
             "slant.",
             {.unit = "px"})
      .param("bias_clamp", &Params::bias_clamp,
             "Most that is added, or if negative least, of a range of depths of 1; 0 is no bound.")
      .param("bias_materials", &Params::bias_materials,
             "Names of the materials whose faces are moved; empty moves all. Reversed, adding brings nearer.")
      .output("visibility", &Outputs::visibility,
              "The face and the depth that was kept; ties go to the lowest source.")
      .output("depth", &Outputs::depth, "The depth alone; where nothing is seen, that of the far plane.")
      .seen(seen_faces<State>);
}

}  // namespace frustum
