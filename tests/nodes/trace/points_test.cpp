#include "nodes/trace/points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "nodes/kernels/triangle_tree.h"
#include "nodes/trace.h"
#include "tests/support/session_run.h"

namespace frustum {
namespace {

using glm::dvec3;

// Weights of random beams against those of beams a little to either side.
TEST(TracePoints, WeightsChangeAsThoseOfTheBeamsBesideDo) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto place = [&] { return dvec3(unit(random), unit(random), unit(random)); };
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::array corner{place(), place(), place()};
    const dvec3 from = place() * 3.0, at = corner[0] * 0.2 + corner[1] * 0.5 + corner[2] * 0.3;
    const kernels::RayBeam beam{from, at - from, place(), place(), place(), place()};
    const std::vector<glm::uvec3> face{{0, 1, 2}};
    const kernels::TriangleTree one(std::span<const dvec3>(corner), face);
    const kernels::RayHit hit = one.nearest({beam.origin, beam.along});
    if (hit.face != 0) continue;
    ++met;
    const kernels::SampleWeights w = kernels::weights_of_hit(corner, beam, hit.u, hit.v);
    // Of the whole line, met in front or behind, inside the triangle or not.
    const auto weight = [&](const dvec3& o, const dvec3& d, int k) {
      const dvec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0], s = o - corner[0],
                  p = glm::cross(d, ac);
      const double det = glm::dot(p, ab), u = glm::dot(s, p) / det, v = glm::dot(d, glm::cross(s, ab)) / det;
      return k == 0 ? 1 - u - v : k == 1 ? u : v;
    };
    const dvec3 n = glm::cross(corner[1] - corner[0], corner[2] - corner[0]);
    if (std::fabs(glm::dot(n, beam.along)) < 0.05)
      continue;  // grazing: the difference below is no derivative
    const double h = 1e-6;
    for (int j = 0; j < 2; ++j) {
      const int k = (w.base + 1 + j) % 3;
      const double by_x = (weight(beam.origin + h * beam.origin_dx, beam.along + h * beam.along_dx, k) -
                           weight(beam.origin - h * beam.origin_dx, beam.along - h * beam.along_dx, k)) /
                          (2 * h),
                   by_y = (weight(beam.origin + h * beam.origin_dy, beam.along + h * beam.along_dy, k) -
                           weight(beam.origin - h * beam.origin_dy, beam.along - h * beam.along_dy, k)) /
                          (2 * h);
      ASSERT_NEAR(j == 0 ? w.u_dx : w.v_dx, by_x, 1e-4 * (1 + std::fabs(by_x))) << i;
      ASSERT_NEAR(j == 0 ? w.u_dy : w.v_dy, by_y, 1e-4 * (1 + std::fabs(by_y))) << i;
    }
  }
  EXPECT_GT(met, 3900);
}

TEST(TracePoints, HitsOfAnotherMeshAreRefused) {
  const test::TempFolder folder;
  const auto run = test::run_in_session(folder, R"({ "format": "frustum.graph/1",
    "nodes": {
      "ring":   { "type": "mesh.torus" }, "box": { "type": "mesh.box" },
      "camera": { "type": "scene.camera", "params": { "resolution": [16, 16] } },
      "rays":   { "type": "trace.camera", "in": { "camera": "camera" } },
      "hits":   { "type": "trace.intersect", "in": { "rays": "rays", "mesh": "ring" } },
      "points": { "type": "trace.points", "in": { "rays": "rays", "hits": "hits", "mesh": "box" } } },
    "outputs": { "o": { "from": "points" } } })",
                                        {"points"});
  EXPECT_EQ(run.said().substr(0, 11), "wrong_mesh:") << run.said();
}

}  // namespace
}  // namespace frustum
