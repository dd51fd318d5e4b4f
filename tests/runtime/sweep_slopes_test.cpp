// Errors fall as fast as theory says: each slope that is stated for a stage that exists, measured with a sweep and held to
// 0.15. Errors do not depend on the machine, so nothing here can be flaky.
#include "runtime/app/sweep/analysis.h"
#include "runtime/app/sweep/sweep.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <vector>

namespace frustum {
namespace {

using test::TempFolder;

// `mesh` is a node with a parameter $n, seen so close that it fills the picture: no silhouette adds an error of its own.
std::string graph(const std::string& mesh, const std::string& camera, const std::string& attributes,
                  const std::string& shading) {
  return fmt::format(R"({{ "format": "frustum.graph/1", "params": {{ "n": 8 }}, "nodes": {{
      "mesh": {},
      "camera": {{ "type": "scene.camera", "params": {} }},
      "light": {{ "type": "light.point", "params": {{ "position": [1.5, 2, 3] }} }},
      "eye": {{ "type": "project.view", "in": {{ "mesh": "mesh", "camera": "camera" }} }},
      "clip": {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
      "cut": {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
      "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }},
      "hits": {{ "type": "rasterize.triangles", "in": {{ "mesh": "screen" }} }},
      "kept": {{ "type": "visibility.zbuffer", "in": {{ "mesh": "screen" }} }},
      "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }},
                  "params": {{ "interpolation": "{}" }} }},
      "lit": {{ "type": "shade.surface", "in": {{ "points": "points", "mesh": "screen", "lights": ["light"] }},
               "params": {{ "interpolation": "{}" }} }} }},
    "outputs": {{ "light": {{ "from": "lit" }}, "depth": {{ "from": "hits.depth" }}, "kept": {{ "from": "kept.depth" }} }} }})",
                     mesh, camera, attributes, shading);
}

const char* const ball = R"({ "type": "mesh.sphere", "params": { "segments": "$n", "rings": "$n" } })";
const char* const at_the_ball = R"({ "eye": [0.8, 0.9, 2.2], "fov_y": 16, "resolution": [96, 54] })";
const char* const ground =
    R"({ "type": "mesh.grid", "params": { "size": [24, 24], "segments": ["$n", "$n"] } })";
const char* const over_the_ground =
    R"({ "eye": [0, 2.5, 8], "target": [0, 0, 1], "fov_y": 24, "resolution": [96, 54] })";

Sweep swept(const std::string& text, const std::string& knob, const std::string& want,
            std::optional<Precision> precision = std::nullopt) {
  const TempFolder folder;
  folder.write("g.json", text);
  SweepOptions o;
  o.graph = folder.file("g.json");
  o.load.precision = precision;
  o.knobs = {knob};
  o.want = want;
  o.repeats = 1;
  o.folder = folder.file("sweep");
  Session session;
  Diagnostics problems;
  auto s = run_sweep(session, o, problems);
  if (!s) throw std::runtime_error(to_text(problems));
  return std::move(*s);
}

double slope(const std::string& text, const std::string& knob, const std::string& want) {
  const Sweep s = swept(text, knob, want);
  if (s.fits.size() != 1 || !s.fits[0].over_value) throw std::runtime_error("nothing could be fitted");
  EXPECT_GT(s.fits[0].over_value->r2, 0.97);
  return s.fits[0].over_value->slope;
}

// A sphere cut to edges h ~ 1/n. The normal of a flat face is off by O(h), light between lit corners by O(h^2).
TEST(SweepSlopes, FlatShadingIsOffByTheLengthOfEdges) {
  EXPECT_NEAR(slope(graph(ball, at_the_ball, "hyperbolic", "flat"), "n=16,32,64,128,1024", "light"), -1,
              slope_tolerance);
}
TEST(SweepSlopes, GouraudShadingIsOffByItsSquare) {
  EXPECT_NEAR(slope(graph(ball, at_the_ball, "hyperbolic", "gouraud"), "n=16,32,64,128,1024", "light"), -2,
              slope_tolerance);
}

// A chord of length h leaves its circle by h^2 / 8.
TEST(SweepSlopes, TessellationIsOffByTheSquareOfEdges) {
  EXPECT_NEAR(slope(graph(ball, at_the_ball, "hyperbolic", "flat"), "n=16,32,64,128,1024", "depth"), -2,
              slope_tolerance);
}

// Over a triangle whose depths differ by the factor 1 + k, an affine share of a corner is off by k/4 of the triangle's
// size, which is itself like k.
TEST(SweepSlopes, AffineInterpolationIsOffByTheSquareOfTheDepthRange) {
  EXPECT_NEAR(slope(graph(ground, over_the_ground, "affine", "phong"), "n=32,64,128,512", "light"), -2,
              slope_tolerance);
}

// A depth kept in b bits is off by 2^-b times a number that is spread evenly.
TEST(SweepSlopes, DepthsAreOffByTheirBits) {
  const Sweep s = swept(graph(ground, over_the_ground, "hyperbolic", "phong"),
                        "kept:format=unorm16,unorm24,unorm32,real", "kept", Precision::real_double);
  std::map<std::string, double> error;
  for (const SweepPoint& p : s.points)
    if (const auto own = p.own_error(0)) error[p.values[0]] = *own;
  EXPECT_NEAR(std::log2(error.at("unorm16") / error.at("unorm24")) / 8, 1, slope_tolerance);
  EXPECT_NEAR(std::log2(error.at("unorm24") / error.at("unorm32")) / 8, 1, slope_tolerance);
}

// ----- what depth is worth at a distance

// A floor that runs from under the camera to the horizon, which stands askew so that no row of pixels has one depth.
std::string floor_to_the_horizon(const std::string& format, bool reversed) {
  return fmt::format(R"({{ "format": "frustum.graph/1", "precision": "double", "nodes": {{
      "floor": {{ "type": "mesh.grid", "params": {{ "size": [4000, 4000] }} }},
      "camera": {{ "type": "scene.camera", "params": {{ "eye": [0, 2, 0], "target": [0.3, 1.6, -4], "up": [0.3, 1, 0],
                  "fov_y": 50, "near": 0.1, "far": 1000, "reversed_z": {}, "resolution": [128, 512] }} }},
      "eye": {{ "type": "project.view", "in": {{ "mesh": "floor", "camera": "camera" }} }},
      "clip": {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
      "cut": {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
      "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }},
      "kept": {{ "type": "visibility.zbuffer", "in": {{ "mesh": "screen" }}, "params": {{ "format": "{}" }} }},
      "exact": {{ "type": "visibility.zbuffer", "in": {{ "mesh": "screen" }}, "params": {{ "format": "real" }} }} }},
    "outputs": {{ "kept": {{ "from": "kept.depth" }}, "exact": {{ "from": "exact.depth" }} }} }})",
                     reversed, format);
}

// How the error of a distance grows with it, where depths are kept in a format: the power of z, fitted over octaves.
double growth_of_error(const std::string& format, bool reversed) {
  Session session;
  const Loaded loaded = load_graph_text(floor_to_the_horizon(format, reversed), "g.json", session.registry());
  if (!loaded.graph) throw std::runtime_error(to_text(loaded.problems));
  RunOptions options;
  for (const char* port : {"kept.depth", "exact.depth"})
    options.demand.ports.push_back(*loaded.graph->find_port(port));
  const RunResult r = session.run(*loaded.graph, options, false);
  const auto raster = [&](std::size_t i) -> const Raster& {
    const Buffer& b = r.buffers.at(options.demand.ports[i]);
    return b.type().raster(b.data());
  };
  const Raster &kept = raster(0), &exact = raster(1);
  // What the perspective of scene.camera does to a distance, solved for it: near at -1 and far at 1; reversed, 1 and 0.
  const auto distance = [&](double depth) {
    constexpr double near = 0.1, far = 1000;
    return reversed ? far * near / (near + depth * (far - near))
                    : 2 * far * near / ((far + near) - depth * (far - near));
  };
  std::map<int, std::pair<double, int>> octaves;  // sum of squares, and how many
  for (int y = 0; y < 512; ++y)
    for (int x = 0; x < 128; ++x) {
      const double z = distance(exact.value(0, 0, x, y));
      if (!(z >= 4 && z < 512)) continue;
      auto& [sum, n] = octaves[static_cast<int>(std::floor(std::log2(z)))];
      const double off = distance(kept.value(0, 0, x, y)) - z;
      sum += off * off, ++n;
    }
  std::vector<std::pair<double, double>> z_and_error;
  for (const auto& [octave, sum] : octaves) {
    EXPECT_GT(sum.second, 50) << "pixels at 2^" << octave;
    z_and_error.emplace_back(std::exp2(octave), std::sqrt(sum.first / sum.second));
  }
  const auto fit = fit_slope(z_and_error);
  if (!fit) throw std::runtime_error("nothing could be fitted");
  EXPECT_EQ(fit->points, 7u);
  EXPECT_GT(fit->r2, 0.97);
  testing::Test::RecordProperty(format + (reversed ? "_reversed" : ""), fmt::format("{:.2f}", fit->slope));
  return fit->slope;
}

// A depth is like 1/z, so that a step of it is a step of z^2 in distance, wherever steps are equal.
TEST(SweepSlopes, EqualStepsOfDepthAreWorthTheSquareOfTheDistance) {
  for (const bool reversed : {false, true})
    EXPECT_NEAR(growth_of_error("unorm24", reversed), 2, slope_tolerance) << reversed;
}

// Far away depths of the usual convention are near 1, where floats have equal steps; reversed, they are near 0, where
// steps are a share of the depth.
TEST(SweepSlopes, ReversedFloatsAreWorthAShareOfTheDistance) {
  EXPECT_NEAR(growth_of_error("float32", false), 2, slope_tolerance);
  EXPECT_NEAR(growth_of_error("float32", true), 1, slope_tolerance);
}

// ----- light

std::string scene_under(const std::string& lamp, const std::string& resolution, const std::string& shadow,
                        const std::string& want) {
  return fmt::format(R"({{ "format": "frustum.graph/1", "params": {{ "n": 128 }}, "nodes": {{
      "floor": {{ "type": "mesh.grid", "params": {{ "size": [8, 8] }} }},
      "box": {{ "type": "mesh.box", "params": {{ "size": [2, 0.4, 1.5] }} }},
      "placed": {{ "type": "transform.affine", "in": {{ "geometry": "box" }}, "params": {{ "steps": [
          {{ "rotate": {{ "axis": [0.3, 1, 0.2], "degrees": 40 }} }}, {{ "translate": [0, 1.4, 0] }}] }} }},
      "scene": {{ "type": "mesh.merge", "in": {{ "meshes": ["floor", "placed"] }} }},
      "lamp": {},
      {}
      "camera": {{ "type": "scene.camera", "params": {{ "eye": [4, 4, 5], "target": [0, 0.6, 0], "resolution": {} }} }},
      "eye": {{ "type": "project.view", "in": {{ "mesh": "scene", "camera": "camera" }} }},
      "clip": {{ "type": "project.perspective", "in": {{ "mesh": "eye", "camera": "camera" }} }},
      "cut": {{ "type": "clip.homogeneous", "in": {{ "mesh": "clip" }} }},
      "screen": {{ "type": "project.viewport", "in": {{ "mesh": "cut", "camera": "camera" }} }},
      "pattern": {{ "type": "supersample.pattern", "params": {{ "samples": 4 }} }},
      "hits": {{ "type": "rasterize.triangles", "in": {{ "mesh": "screen", "pattern": "pattern" }} }},
      "points": {{ "type": "rasterize.attributes", "in": {{ "hits": "hits", "mesh": "screen" }} }} }},
    "outputs": {{ "seen": {{ "from": "{}" }} }} }})",
                     lamp, shadow, resolution, want);
}

double declared_slope(const std::string& text, const std::string& knob, const std::string& want) {
  const Sweep s = swept(text, knob, want);
  if (s.fits.size() != 1 || !s.fits[0].over_value || !s.knobs[0].slope)
    throw std::runtime_error("nothing could be fitted");
  EXPECT_EQ(agrees_with_theory(s.fits[0], s.knobs[0]), true)
      << s.fits[0].over_value->slope << " is declared as " << *s.knobs[0].slope;
  EXPECT_GT(s.fits[0].over_value->r2, 0.9);
  testing::Test::RecordProperty("slope", fmt::format("{:.2f}", s.fits[0].over_value->slope));
  return s.fits[0].over_value->slope;
}

// What an edge hides of n points of a lamp: like n samples of a pixel.
TEST(SweepSlopes, PenumbrasAreOffLikeEdges) {
  const auto text = scene_under(
      R"({ "type": "light.area", "params": { "position": [0.5, 4, 0.5], "edge_u": [1.2, 0, 0], "edge_v": [0, 0, 1.2], "samples": "$n" } })",
      "[48, 36]",
      R"("shadow": { "type": "shade.shadow", "in": { "points": "points", "mesh": "screen", "casters": "scene", "lights": ["lamp"] } },
         "lit": { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "lights": ["lamp"], "visibility": "shadow" } },)",
      "lit");
  EXPECT_NEAR(declared_slope(text, "n=1,4,16,64,512", "seen"), -0.75, slope_tolerance);
}

// Every edge of a shadow is a texel wide, and wrong there by all there is: the mean of squares is like a texel.
TEST(SweepSlopes, ShadowMapsAreOffByTheRootOfATexel) {
  const auto text = scene_under(
      R"({ "type": "light.directional" })", "[240, 180]",
      R"("at_lamp": { "type": "light.camera", "in": { "light": "lamp", "mesh": "scene" }, "params": { "size": "$n" } },
         "map": { "type": "graph", "file": "lib:shadow_map_parallel", "in": { "mesh": "scene", "camera": "at_lamp" } },
         "shadow": { "type": "shade.shadow_map", "in": { "points": "points", "mesh": "screen", "lights": ["lamp"],
                     "maps": ["map"], "cameras": ["at_lamp"] }, "params": { "radius": 0 } },)",
      "shadow");
  EXPECT_NEAR(declared_slope(text, "n=64,90,128,181,256,362,512,4096", "seen"), -0.5, slope_tolerance);
}

// Where the horizon cuts the lobe there is a kink: each row of Gauss's points is off by order^-2, with either sign from
// row to row, so that the mean of all rows is off by order^-5/2.
TEST(SweepSlopes, QuadratureOfACutLobeIsOffByItsKink) {
  const std::string text = R"({ "format": "frustum.graph/1", "params": { "n": 16 }, "nodes": {
      "clay": { "type": "shade.material", "params": { "diffuse": [0, 0, 0], "specular": 0.4, "shininess": 10, "model": "phong" } },
      "energy": { "type": "check.energy", "in": { "material": "clay" }, "params": { "order": "$n", "angles": 15 } } },
    "outputs": { "table": { "from": "energy" } } })";
  EXPECT_NEAR(declared_slope(text, "n=5,8,11,16,23,32,45,256", "table"), -2.5, slope_tolerance);
}

// The twin that must fail: a slope next to the theory of another stage is outside of it, and the report says so.
TEST(SweepSlopes, ASlopeOfAnotherPowerDoesNotPass) {
  const Sweep s = swept(graph(ball, at_the_ball, "hyperbolic", "flat"), "n=16,32,64,128,1024", "light");
  SweepKnob knob = s.knobs[0];
  knob.slope = -1;
  EXPECT_EQ(agrees_with_theory(s.fits[0], knob), true);
  knob.slope = -2;
  EXPECT_EQ(agrees_with_theory(s.fits[0], knob), false);
  knob.slope.reset();
  EXPECT_EQ(agrees_with_theory(s.fits[0], knob), std::nullopt);
}

}  // namespace
}  // namespace frustum
