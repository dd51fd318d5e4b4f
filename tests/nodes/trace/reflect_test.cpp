#include "nodes/trace/reflect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "tests/support/session_run.h"

namespace frustum {
namespace {

using glm::dvec3;
using kernels::RayBeam, kernels::SurfacePoint;

// The course's row 77, errata E46: as long, in the plane of ray and normal, and at the same angle on the other side.
TEST(TraceReflect, KeepsLengthAndAngle) {
  std::mt19937 random(29);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto place = [&] { return dvec3(unit(random), unit(random), unit(random)); };
  for (int i = 0; i < 1000; ++i) {
    const dvec3 n = glm::normalize(place());
    const RayBeam in{.along = place() * std::exp2(20 * unit(random))};
    const auto out = trace::mirrored(in, {.p = place(), .n = n * 3.0, .face_normal = n});
    ASSERT_TRUE(out);
    const double length = glm::length(in.along);
    EXPECT_NEAR(glm::length(out->along), length, 2e-15 * length);
    EXPECT_NEAR(glm::dot(out->along, n), -glm::dot(in.along, n), 2e-15 * length);
    EXPECT_NEAR(glm::dot(out->along, glm::cross(in.along, n)), 0, 2e-15 * length * length);
  }
}

// A ray beside another leaves a ball beside it: the derivatives against those of mirrored rays a little to the side.
TEST(TraceReflect, ChangesAsTheRaysBesideDo) {
  const auto on_ball = [](const dvec3& o,
                          const dvec3& d) {  // a ball of radius 1 around the origin, from outside
    const double b = glm::dot(o, d), c = glm::dot(o, o) - 1, a = glm::dot(d, d);
    return o + (-b - std::sqrt(b * b - a * c)) / a * d;
  };
  const dvec3 o(0, 0, 5), d(0.1, -0.05, -1), dd(0.01, 0.002, 0);
  const double h = 1e-5;
  const auto beam_at = [&](double x) {
    const dvec3 p = on_ball(o, d + x * dd);
    return trace::mirrored({.origin = o, .along = d + x * dd}, {.p = p, .n = p * 2.0, .face_normal = p})
        ->along;
  };
  const dvec3 p = on_ball(o, d), p_dx = (on_ball(o, d + h * dd) - on_ball(o, d - h * dd)) / (2 * h);
  const auto out =
      trace::mirrored({.origin = o, .along = d, .along_dx = dd},
                      {.p = p, .p_dx = p_dx, .n = p * 2.0, .n_dx = p_dx * 2.0, .face_normal = p});
  const dvec3 expected = (beam_at(h) - beam_at(-h)) / (2 * h);
  EXPECT_LT(glm::length(out->along_dx - expected), 1e-7 * glm::length(expected));
  EXPECT_GT(glm::length(expected), 5 * glm::length(dd)) << "a ball spreads what it mirrors";
  EXPECT_EQ(out->origin_dx, p_dx);
}

TEST(TraceReflect, AMirrorNeverShowsItsOwnInside) {
  // A shading normal that leans so far that it would send a grazing ray down.
  const dvec3 face(0, 1, 0), shading = glm::normalize(dvec3(0.5, 1, 0));
  const auto out = trace::mirrored({.along = {1, -0.1, 0}}, {.n = shading, .face_normal = face});
  EXPECT_EQ(out->along, dvec3(1, 0.1, 0));
  EXPECT_LT(dvec3(1, -0.1, 0).y - 2 * glm::dot(dvec3(1, -0.1, 0), shading) * shading.y, 0.9);
}

TEST(TraceReflect, WithoutAnyNormalThereIsNoRay) {
  EXPECT_FALSE(trace::mirrored({.along = {1, -0.1, 0}}, {}));
  EXPECT_TRUE(trace::mirrored({.along = {1, -0.1, 0}}, {.face_normal = {0, 1, 0}}));
}

// A flat mirror shows what a camera behind it would see: the ring over a floor, and the ring below it.
TEST(TraceReflect, AFlatMirrorShowsTheSceneMirrored) {
  const test::TempFolder folder;
  const auto graph = [](const char* eye, const char* target, const char* up, bool mirror) {
    return fmt::format(
        R"({{ "format": "frustum.graph/1", "precision": "double",
    "nodes": {{
      "floor":  {{ "type": "mesh.grid", "params": {{ "size": [40, 40] }} }},
      "ring":   {{ "type": "mesh.torus", "params": {{ "segments": 24, "sides": 12 }} }},
      "placed": {{ "type": "transform.affine", "in": {{ "geometry": "ring" }}, "params": {{ "steps": [{{ "translate": [0, 3, 0] }}] }} }},
      "camera": {{ "type": "scene.camera", "params": {{ "eye": {}, "target": {}, "up": {}, "resolution": [60, 40] }} }},
      "rays":   {{ "type": "trace.camera", "in": {{ "camera": "camera" }} }},
      {}
      "hits":   {{ "type": "trace.intersect", "in": {{ "rays": "{}", "mesh": "placed" }} }} }},
    "outputs": {{ "o": {{ "from": "hits" }} }} }})",
        eye, target, up,
        mirror ? R"("down": { "type": "trace.intersect", "in": { "rays": "rays", "mesh": "floor" } },
      "floored": { "type": "trace.points", "in": { "rays": "rays", "hits": "down", "mesh": "floor" } },
      "up": { "type": "trace.reflect", "in": { "rays": "rays", "points": "floored", "mesh": "floor" } },)"
               : "",
        mirror ? "up" : "rays");
  };
  const auto mirrored =
      test::run_in_session(folder, graph("[0, 2, 6]", "[0, -3, 0]", "[0, 1, 0]", true), {"hits"});
  const auto behind =
      test::run_in_session(folder, graph("[0, -2, 6]", "[0, 3, 0]", "[0, -1, 0]", false), {"hits"});
  ASSERT_TRUE(!mirrored.buffers.empty() && !behind.buffers.empty()) << mirrored.said() << behind.said();
  const Raster &a = mirrored.image(), &b = behind.image();
  int seen = 0;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) {
      // With y turned over, right and left stay where the other camera, on its head, sees them the other way round.
      const auto id = a.at<std::uint32_t>(0, 0, x, y), there = b.at<std::uint32_t>(0, 0, 59 - x, y);
      ASSERT_EQ(id == no_face, there == no_face) << x << ' ' << y;
      seen += id != no_face;
    }
  EXPECT_GT(seen, 200);
}

// Rays may go on from what the rasterizer has drawn: first hits on the screen, mirrors by rays.
TEST(TraceReflect, GoesOnFromPointsOfTheRasterizer) {
  const test::TempFolder folder;
  const auto run = test::run_in_session(folder, R"({ "format": "frustum.graph/1", "nodes": {
    "plane":  { "type": "mesh.grid", "params": { "size": [8, 8] } },
    "ring":   { "type": "mesh.torus" },
    "placed": { "type": "transform.affine", "in": { "geometry": "ring" }, "params": { "steps": [{ "translate": [0, 1.4, 0] }] } },
    "scene":  { "type": "mesh.merge", "in": { "meshes": ["plane", "placed"] } },
    "camera": { "type": "scene.camera", "params": { "eye": [4, 4, 5], "resolution": [120, 80] } },
    "rays":   { "type": "trace.camera", "in": { "camera": "camera" } },
    "met":    { "type": "trace.intersect", "in": { "rays": "rays", "mesh": "scene" } },
    "there":  { "type": "trace.points", "in": { "rays": "rays", "hits": "met", "mesh": "scene" } },
    "sent":   { "type": "trace.reflect", "in": { "rays": "rays", "points": "there", "mesh": "scene" } },
    "a":      { "type": "trace.intersect", "in": { "rays": "sent", "mesh": "scene" } },
    "eye":    { "type": "project.view", "in": { "mesh": "scene", "camera": "camera" } },
    "clip":   { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "cut":    { "type": "clip.homogeneous", "in": { "mesh": "clip" } },
    "front":  { "type": "cull.backface", "in": { "mesh": "cut" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "front", "camera": "camera" } },
    "hits":   { "type": "rasterize.triangles", "in": { "mesh": "screen" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "drawn":  { "type": "trace.reflect", "in": { "rays": "rays", "points": "points", "mesh": "screen" } },
    "b":      { "type": "trace.intersect", "in": { "rays": "drawn", "mesh": "scene" } } },
    "outputs": { "a": { "from": "a" }, "b": { "from": "b" } } })",
                                        {"a", "b"});
  ASSERT_EQ(run.buffers.size(), 2u) << run.said();
  int met = 0, other = 0;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 120; ++x) {
      const auto a = run.image(0).at<std::uint32_t>(0, 0, x, y),
                 b = run.image(1).at<std::uint32_t>(0, 0, x, y);
      met += a != no_face;
      other += a != b;
    }
  EXPECT_GT(met, 500);
  EXPECT_LT(other, met / 20);
}

}  // namespace
}  // namespace frustum
