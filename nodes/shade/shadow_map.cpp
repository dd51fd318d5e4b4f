#include "nodes/shade/shadow_map.h"

#include "nodes/shade.h"
#include "runtime/buffers/seen_points.h"
#include "runtime/buffers/visible_lights.h"
#include "runtime/core/node_type.h"

#include <fmt/format.h>

namespace frustum {
namespace {

constexpr std::string_view shadows_name = "shadows";

struct Inputs {
  Tiled<Image> points;
  Ref<Mesh> mesh;
  std::vector<Ref<LightSet>> lights;
  std::vector<Ref<Depth>> maps;
  std::vector<Ref<Camera>> cameras;
};
struct Params {
  double bias = 1;
  int radius = 1;
};
struct Outputs {
  Tiled<Image> visibility;
};

using Source = kernels::LightSource<double>;

struct Map {
  shadow_map::View view;
  Ref<Depth> depth;
  Tile rows;
  bool single;     // precision of its numbers
  double step_px;  // of the grid that its corners snapped to

  double at(int x, int y) const {
    return single ? static_cast<double>(rows.row<const float>(0, 0, y)[x])
                  : rows.row<const double>(0, 0, y)[x];
  }
  glm::ivec2 size() const { return {depth->raster.frame().window.x1, depth->raster.frame().window.y1}; }
};

// A source and where its maps begin: one, or the six sides of the cube around a point light.
struct Lamp {
  Source source;
  std::size_t first_map;
  bool cube() const { return source.is_point && !source.is_spot; }
};

struct State {
  Params params;
  std::vector<Map> maps;
  std::vector<Lamp> lamps;
  SeenPoints points;
};

Verdict shadows(const Inputs& in, const Params&, const Context&) {
  const std::size_t sources = light_sources(in.lights).size();
  const Frame& f = in.points.frame();
  const std::uint64_t tests =
      static_cast<std::uint64_t>(f.window.area()) * static_cast<std::uint64_t>(f.samples()) * sources;
  if (sources == 0) return off_exact("no light but ambient light, which casts no shadow");
  return on(fmt::format("{} sources of light have a map of depth", sources), tests);
}

Map map_of(const Inputs& in, std::size_t i, bool place) {
  const Camera& c = *in.cameras[i];
  const Frame& f = in.maps[i]->raster.frame();
  const std::string input = fmt::format("maps/{}", i);
  if (f.window != Rect{0, 0, c.resolution.x, c.resolution.y})
    throw NodeError("different_frames",
                    fmt::format("map {} is not a picture of the size that its camera takes", i),
                    at_input(input));
  if (f.samples() > 1)
    throw NodeError("sampled_map",
                    fmt::format("map {} has {} samples a pixel; a shadow map has one", i, f.samples()),
                    at_input(input));
  const kernels::Projection volume =
      place ? kernels::perspective(c.fov_y, c.aspect(), c.near_z, c.far_z, clip_space(&c))
            : kernels::orthographic(c.height, c.aspect(), c.near_z, c.far_z, clip_space(&c));
  return {{kernels::look_at(c.eye, c.target, c.up).eye_from_world, volume, viewport_of(c)},
          in.maps[i],
          in.maps[i]->raster.view(),
          f.planes[0].kind == PlaneKind::f32,
          std::exp2(-c.subpixel_bits)};
}

void add_lamps(const Inputs& in, State& s) {
  for (const Source& source : light_sources(in.lights)) {
    s.lamps.push_back({source, s.maps.size()});
    for (std::size_t side = 0; side < (s.lamps.back().cube() ? 6u : 1u); ++side)
      s.maps.push_back(map_of(in, s.maps.size(), source.is_point));
  }
}

void require_maps(const Inputs& in) {
  std::size_t wanted = 0;
  for (const Source& s : light_sources(in.lights)) {
    if (s.is_patch)
      throw NodeError("area_light", "a light with an area is in no one place: shade.shadow finds its shadows",
                      at_input("lights"));
    wanted += s.is_point && !s.is_spot ? 6 : 1;
  }
  if (in.maps.size() != wanted)
    throw NodeError(
        "wrong_maps",
        fmt::format("the lights need {} maps (six for a point light, +x -x +y -y +z -z), and {} are linked",
                    wanted, in.maps.size()),
        at_input("maps"));
  if (in.cameras.size() != in.maps.size())
    throw NodeError("wrong_maps",
                    fmt::format("{} maps were taken by {} cameras", in.maps.size(), in.cameras.size()),
                    at_input("cameras"));
}

Prepared<State, Outputs> prepare(const Inputs& in, const Params& p, Context& ctx) {
  const Frame& from = in.points.frame();
  Frame frame{.window = from.window, .pattern = from.pattern};
  State s{.params = p, .maps = {}, .lamps = {}, .points = read_points(in.points, in.mesh)};
  require_maps(in);
  if (ctx.simulates(shadows_name)) add_lamps(in, s);
  for (std::size_t i = 0; i < s.lamps.size(); ++i)
    frame.planes.push_back({visibility_plane(i), real_kind(ctx.precision)});
  return {std::move(s), {std::move(frame)}};
}

// +x -x +y -y +z -z: the side of the cube that the way from a point light leaves through.
std::size_t side_of_cube(const glm::dvec3& way) {
  const glm::dvec3 size(std::fabs(way.x), std::fabs(way.y), std::fabs(way.z));
  const glm::length_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  return 2 * static_cast<std::size_t>(axis) + (way[axis] < 0 ? 1 : 0);
}

double reach_of(const State& s, const Lamp& lamp, const kernels::SeenFace& face, const glm::dvec3& p) {
  const auto& l = lamp.source.place;
  const Map& map =
      s.maps[lamp.first_map + (lamp.cube() ? side_of_cube(p - glm::dvec3(l[0], l[1], l[2])) : 0)];
  const auto seen = shadow_map::seen_from_light(map.view, face, p);
  if (!seen) return 1;
  const double u = map.single ? 0x1p-24 : 0x1p-53;
  const double tolerance =
      shadow_map::depth_tolerance(*seen, face, s.params.bias, s.params.radius + 0.5, map.step_px, u);
  return shadow_map::share_of_light(*seen, tolerance, s.params.radius, map.size(),
                                    map.view.volume.space.depth, [&](int x, int y) { return map.at(x, y); });
}

void tile(const State& s, const TilesOf<Inputs>& in, const TilesOf<Outputs>& out, Arena& arena) {
  fill_shares(s.points, in[&Inputs::points], out[&Outputs::visibility], arena,
              [&](std::size_t i, const kernels::SeenFace& face, const glm::dvec3& p, std::uint32_t&) {
                return reach_of(s, s.lamps[i], face, p);
              });
}

}  // namespace

NodeType nodes::shade_shadow_map() {
  return pixel_node("shade.shadow_map", prepare, tile)
      .doc(
          "Finds how much of each light reaches each visible point, by depths that were seen from the light.")
      .cite("Williams 1978, Casting curved shadows on curved surfaces, doi:10.1145/965139.807402")
      .cite(
          "Reeves, Salesin & Cook 1987, Rendering antialiased shadows with depth maps, "
          "doi:10.1145/37402.37435")
      .covers(61)
      .input("points", &Inputs::points, "Visible points: id and P.")
      .input("mesh", &Inputs::mesh, "The mesh the points were seen on; its faces give the slope of depth.")
      .input("lights", &Inputs::lights, "Directional, spot and point lights, as shade.surface gets them.")
      .input("maps", &Inputs::maps,
             "Depth from each light in turn, one sample a pixel; six for a point light.")
      .input("cameras", &Inputs::cameras, "Of each map: light.camera.")
      .param("bias", &Params::bias,
             "In depths of the face's slope over half a texel; raising it detaches shadows, below 1 lit "
             "faces spot.",
             {.range = between(0, 64)})
      .param("radius", &Params::radius,
             "Texels around a point that count; raising it softens edges over a band of twice that.",
             {.unit = "texels", .range = between(0, 16)})
      .knob_of_taste({"0", "1", "2", "4"}, "Edges are blurred to hide texels, not as a lamp's size would.")
      .effect(shadows_name, shadows, "Depths around every point are compared with those that each light saw.",
              {"sample and light", 40})
      .output("visibility", &Outputs::visibility,
              "V0, V1 ..: the share of each source of light that reaches a point.")
      .blank_where(&Inputs::points);
}

}  // namespace frustum
