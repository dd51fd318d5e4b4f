// Errors fall as fast as theory says: each slope that is stated for a stage that exists, measured with a sweep and held to
// 0.15. Errors do not depend on the machine, so nothing here can be flaky.
#include "runtime/app/sweep/analysis.h"
#include "runtime/app/sweep/sweep.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

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
