#include "nodes/shade/shadow.h"

#include "nodes/shade.h"
#include "runtime/buffers/seen_points.h"
#include "runtime/buffers/shadow_facts.h"
#include "runtime/buffers/visible_lights.h"
#include "runtime/core/node_type.h"

namespace frustum {
namespace {

constexpr std::string_view shadows_name = "shadows";

struct Inputs {
  Tiled<Image> points;
  Ref<Mesh> mesh, casters;
  std::vector<Ref<LightSet>> lights;
};
struct Params {};
struct Outputs {
  Tiled<Image> visibility;
};

using Source = kernels::LightSource<double>;

struct State {
  kernels::TriangleTree occluders;
  std::vector<Source> sources;  // by plane
  SeenPoints points;
};

Ref<Column> caster_positions(const Mesh& mesh) {
  Ref<Column> c = mesh.real<double>("position");
  if (c->width() != 3)
    throw NodeError("wrong_column", "positions in world space have three components", at_input("casters"));
  return c;
}

std::vector<std::string> witnesses(const Inputs& in, std::span<const Source> sources) {
  if (in.casters->faces() == 0) return std::vector<std::string>(sources.size());
  const Ref<Column> seen = world_positions<double>(*in.mesh), casters = caster_positions(*in.casters);
  return witnesses_of_shadow(
      {seen->values<glm::dvec3>(), in.mesh->triangles(), casters->values<glm::dvec3>()}, sources);
}

Verdict shadows(const Inputs& in, const Params&, const Context&) {
  const std::vector<Source> sources = light_sources(in.lights);
  const Frame& f = in.points.frame();
  return needs_shadows(witnesses(in, sources), in.casters->faces(),
                       static_cast<std::uint64_t>(f.window.area()) * static_cast<std::uint64_t>(f.samples()));
}

// Those that may be hidden, or all of them where they are asked for; with the names of their planes.
std::vector<Source> choose(const Inputs& in, const Context& ctx, PlaneList& planes) {
  std::vector<Source> chosen;
  if (!ctx.simulates(shadows_name)) return chosen;
  const std::vector<Source> all = light_sources(in.lights);
  const std::vector<std::string> why = witnesses(in, all);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (why[i].empty() && !ctx.forces(shadows_name)) continue;
    planes.push_back({visibility_plane(i), real_kind(ctx.precision)});
    chosen.push_back(all[i]);
  }
  return chosen;
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params&, Context& ctx) {
  const Frame& from = in.points.frame();
  Frame frame{.window = from.window, .pattern = from.pattern};
  State s{
      .occluders = {}, .sources = choose(in, ctx, frame.planes), .points = read_points(in.points, in.mesh)};
  if (!s.sources.empty()) {
    ctx.claim(kernels::TriangleTree::bytes(in.casters->faces()));
    const Ref<Column> at = caster_positions(*in.casters);
    s.occluders = {at->values<glm::dvec3>(), in.casters->triangles(), [&ctx] { ctx.poll(); }};
  }
  ctx.count("light_sources_tested", s.sources.size());
  return {std::move(s), {std::move(frame)}};
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  fill_shares(s.points, in[&Inputs::points], out[&Outputs::visibility], arena,
              [&](std::size_t i, const kernels::SeenFace& face, const glm::dvec3& p, std::uint32_t& last) {
                return s.occluders.hide(shadow::sight(p, s.sources[i]), face.slack, last) ? 0.0 : 1.0;
              });
}

}  // namespace

NodeType nodes::shade_shadow() {
  return pixel_node("shade.shadow", prepare, tile)
      .doc("Finds the lights that each visible point sees: hidden surfaces as the light has them, exactly.")
      .cite(
          "Appel 1968, Some techniques for shading machine renderings of solids, doi:10.1145/1468075.1468082")
      .cite("Woop, Benthin & Wald 2013, Watertight ray/triangle intersection, JCGT 2(1)")
      .covers(61, 76)
      .input("points", &Inputs::points, "Visible points: id and P.")
      .input("mesh", &Inputs::mesh,
             "The mesh the points were seen on; it says where a point's own face lies.")
      .input("casters", &Inputs::casters,
             "All that casts shadows, before anything of it is culled or clipped away.",
             {.space = {Space::object, Space::world}})
      .input("lights", &Inputs::lights, "The lights, in the order in which shade.surface gets them.")
      .effect(shadows_name, shadows, "Every light is looked for from every point, past all that may hide it.",
              {"sample and light", 150})
      .output(
          "visibility", &Outputs::visibility,
          "V0, V1 ..: 1 where a source of light is seen, 0 where something hides it; none where all see it.")
      .blank_where(&Inputs::points);
}

}  // namespace frustum
