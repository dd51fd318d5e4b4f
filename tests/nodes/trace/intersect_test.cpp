#include "nodes/trace/intersect.h"

#include <gtest/gtest.h>

#include <cmath>

#include "nodes/trace.h"
#include "runtime/buffers/rays.h"
#include "tests/support/meshes.h"
#include "tests/support/session_run.h"
#include "tests/support/tiles.h"

namespace frustum {
namespace {

// A ring over a floor, by rays and by triangles on the screen.
constexpr const char* both = R"({
  "format": "frustum.graph/1", "precision": "double",
  "nodes": {
    "floor":   { "type": "mesh.grid", "params": { "size": [8, 8] } },
    "ring":    { "type": "mesh.torus", "params": { "segments": 48, "sides": 24 } },
    "placed":  { "type": "transform.affine", "in": { "geometry": "ring" }, "params": { "steps": [{ "rotate": { "axis": [1, 0, 0], "degrees": 60 } }, { "translate": [0, 1.4, 0] }] } },
    "scene":   { "type": "mesh.merge", "in": { "meshes": ["floor", "placed"] } },
    "camera":  { "type": "scene.camera", "params": { "eye": [4, 4, 5], "target": [0, 0.6, 0], "height": 5, "resolution": [160, 120] } },
    "pattern": { "type": "supersample.pattern", "params": { "samples": 4, "kind": "sobol" } },
    "eye":     { "type": "project.view", "in": { "mesh": "scene", "camera": "camera" } },
    "clip":    { "type": "project.$PROJECTION", "in": { "mesh": "eye", "camera": "camera" } },
    "screen":  { "type": "project.viewport", "in": { "mesh": "clip", "camera": "camera" } },
    "seen":    { "type": "rasterize.triangles", "in": { "mesh": "screen", "pattern": "pattern" } },
    "there":   { "type": "rasterize.attributes", "in": { "hits": "seen", "mesh": "screen" } },
    "rays":    { "type": "trace.camera", "in": { "camera": "camera", "pattern": "pattern" }, "params": { "projection": "$PROJECTION" } },
    "hits":    { "type": "trace.intersect", "in": { "rays": "rays", "mesh": "scene" } },
    "points":  { "type": "trace.points", "in": { "rays": "rays", "hits": "hits", "mesh": "scene" } } },
  "outputs": { "o": { "from": "points" }, "there": { "from": "there" } } })";

std::string with(std::string text, std::string_view projection) {
  for (std::size_t at; (at = text.find("$PROJECTION")) != std::string::npos;)
    text.replace(at, 11, projection);
  return text;
}

double number(const Raster& r, std::string_view plane, int sample, int x, int y) {
  return r.value(*r.frame().find(plane), sample, x, y);
}

// Corners on the screen snap to 2^-8 px, so that samples within that of a side may see another face, or past it; all
// others see the same face at the same distance, and attributes that differ as little.
TEST(TraceIntersect, SeesWhatTheRasterizerSees) {
  for (const char* projection : {"perspective", "orthographic"}) {
    const test::TempFolder folder;
    const auto run = test::run_in_session(folder, with(both, projection), {"points", "there", "hits"});
    ASSERT_EQ(run.buffers.size(), 3u) << run.said();
    const Raster &rays = run.image(0), &raster = run.image(1), &hits = run.image(2);
    int seen = 0, other = 0, other_slopes = 0;
    for (int k = 0; k < 4; ++k)
      for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x) {
          const double id = number(rays, "id", k, x, y);
          if (id != number(raster, "id", k, x, y)) {
            ++other;
            continue;
          }
          if (id == no_face) continue;
          ++seen;
          if (std::string_view(projection) == "perspective") {
            ASSERT_NEAR(number(hits, "t", k, x, y), number(raster, "w", k, x, y), 0.02);
          }
          for (const char* plane : {"P.x", "P.y", "P.z", "uv.u", "uv.v", "N.x", "N.y", "N.z"})
            ASSERT_NEAR(number(rays, plane, k, x, y), number(raster, plane, k, x, y), 0.02) << plane;
          // Where a face is seen edge-on, a snapped corner turns it by more than a little.
          for (const char* plane : {"uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy", "P.dx_dx", "P.dz_dy"}) {
            const double a = number(rays, plane, k, x, y), b = number(raster, plane, k, x, y);
            other_slopes += !(std::fabs(a - b) < 0.002 + 0.05 * std::fabs(b));
          }
        }
    EXPECT_GT(seen, 20000) << projection;
    EXPECT_LT(other, 0.005 * 4 * 160 * 120) << projection;
    EXPECT_LT(other_slopes, 0.005 * 6 * seen) << projection;
  }
}

// One ray a pixel, of the numbers given: O, D and slack.
Buffer rays_of(const std::vector<std::array<double, 7>>& of) {
  Frame f{.window = {0, 0, static_cast<int>(of.size()), 1}, .planes = ray_planes(PlaneKind::f64)};
  Raster r(std::move(f));
  for (std::size_t x = 0; x < of.size(); ++x)
    for (int i = 0; i < 7; ++i) r.view().row<double>(i, 0, 0)[x] = of[x][static_cast<std::size_t>(i)];
  return Buffer(std::make_shared<const Image>(Image{std::move(r)}));
}

TEST(TraceIntersect, NoRayAndRaysThatAreNoNumbersMeetNothing) {
  const double nan = std::nan("");
  const std::vector<glm::vec3> p{{-1, -1, 0}, {1, -1, 0}, {0, 2, 0}};
  const Mesh one = test::mesh_of(p, {{0, 1, 2}}, Space::world);
  const Raster hits = test::PixelRun(nodes::trace_intersect(), "{}",
                                     {{"rays",
                                       {rays_of({{0, 0, 3, 0, 0, -2, 0},        // met
                                                 {0, 0, 3, 0, 0, 0, 0},         // no ray
                                                 {0, 0, 3, 0, nan, -1, 0},      // no numbers
                                                 {0, 0, 3, 0, 0, 1, 0},         // the other way
                                                 {0, 0, 1e-9, 0, 0, -1, 1e-6},  // it starts there
                                                 {0, 0, -1, 0, 0, 1e-300, 0}})}},
                                      {"mesh", {Buffer(test::shared(one))}}},
                                     Precision::real_double)
                          .whole();
  const auto id = [&](int x) { return hits.at<std::uint32_t>(0, 0, x, 0); };
  EXPECT_EQ(id(0), 0u);
  EXPECT_EQ(number(hits, "t", 0, 0, 0), 1.5);
  EXPECT_NEAR(number(hits, "u", 0, 0, 0), 1.0 / 3, 1e-15);
  EXPECT_NEAR(number(hits, "v", 0, 0, 0), 1.0 / 3, 1e-15);
  for (const int x : {1, 2, 3, 4}) {
    EXPECT_EQ(id(x), no_face) << x;
    EXPECT_EQ(number(hits, "t", 0, x, 0), 0) << x;
  }
  EXPECT_EQ(id(5), 0u) << "a way is as good as its length";
}

}  // namespace
}  // namespace frustum
