#include "nodes/trace/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "nodes/trace.h"
#include "runtime/buffers/camera.h"
#include "tests/support/session_run.h"
#include "tests/support/tiles.h"

namespace frustum {
namespace {

using glm::dvec2, glm::dvec3;

struct View {
  kernels::LookAt look;
  kernels::Projection projection;
  kernels::Viewport viewport;
  trace::CameraRays rays() const { return {look, projection, viewport}; }

  // x_px, y_px and the distance along the view axis.
  dvec3 project(const dvec3& p) const {
    const dvec3 eye = look.eye_from_world.linear * p + look.eye_from_world.translation;
    const glm::dvec4 clip = kernels::ClipMap<double>(projection)(eye);
    return {viewport.x_px(clip.x / clip.w), viewport.y_px(clip.y / clip.w), -eye.z};
  }
};

View view(bool perspective, bool y_down, glm::ivec2 size, const dvec3& eye, const dvec3& target) {
  const kernels::ClipSpace space{.y_down = y_down};
  const double aspect = static_cast<double>(size.x) / size.y;
  return {kernels::look_at(eye, target, {0, 1, 0}),
          perspective ? kernels::perspective(0.7, aspect, 0.1, 100, space)
                      : kernels::orthographic(3, aspect, 0.1, 100, space),
          kernels::Viewport(size, y_down)};
}

// The oracle of the course's row 71: what lies on a pixel's ray projects to the pixel, wherever it lies, and t is the
// distance along the view.
TEST(TraceCamera, EveryPointOfARayProjectsToItsPixel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const bool perspective : {true, false})
    for (const bool y_down : {true, false})
      for (const glm::ivec2 size :
           {glm::ivec2(64, 48), glm::ivec2(1, 1), glm::ivec2(1, 4096), glm::ivec2(7, 1)})
        for (int i = 0; i < 50; ++i) {
          const View v =
              view(perspective, y_down, size, {unit(random) * 5, unit(random) * 5, unit(random) * 5},
                   {unit(random), unit(random), unit(random)});
          const dvec2 px{(unit(random) + 1) / 2 * size.x, (unit(random) + 1) / 2 * size.y};
          const kernels::RayBeam ray = v.rays().at(px);
          for (const double t : {0.5, 1.0, 37.0}) {
            const dvec3 back = v.project(ray.origin + t * ray.along);
            ASSERT_NEAR(back.x, px.x, 1e-9 * size.x);
            ASSERT_NEAR(back.y, px.y, 1e-9 * size.y);
            ASSERT_NEAR(back.z, t, 1e-12 * t);
          }
        }
}

// Errata E41: c goes with x and r with y, so the corners of the picture are those of the view volume.
TEST(TraceCamera, CornersAreThoseOfTheViewVolume) {
  const View v = view(true, false, {200, 100}, {0, 0, 0}, {0, 0, -1});
  const double up = std::tan(0.35);
  const dvec3 top_left = v.rays().at({0, 0}).along, bottom_right = v.rays().at({200, 100}).along;
  EXPECT_NEAR(glm::length(top_left - dvec3(-2 * up, up, -1)), 0, 1e-15);
  EXPECT_NEAR(glm::length(bottom_right - dvec3(2 * up, -up, -1)), 0, 1e-15);
}

TEST(TraceCamera, ChangesAreThoseToTheNextPixel) {
  for (const bool perspective : {true, false})
    for (const bool y_down : {true, false}) {
      const trace::CameraRays rays = view(perspective, y_down, {64, 48}, {3, 2, 5}, {0, 0, 0}).rays();
      const kernels::RayBeam at = rays.at({20.5, 11.5}), right = rays.at({21.5, 11.5}),
                             below = rays.at({20.5, 12.5});
      EXPECT_LT(glm::length((right.along - at.along) - at.along_dx), 1e-15);
      EXPECT_LT(glm::length((below.along - at.along) - at.along_dy), 1e-15);
      EXPECT_LT(glm::length((right.origin - at.origin) - at.origin_dx), 1e-15);
      EXPECT_LT(glm::length((below.origin - at.origin) - at.origin_dy), 1e-15);
      EXPECT_GT(glm::length(perspective ? at.along_dx : at.origin_dx), 0.01);
    }
}

// Hard case RAY-24: 1e7 from the origin a point of the picture in float has lost the way, which is at most 4e-4 across.
TEST(TraceCamera, FarFromTheOriginTheWayKeepsItsDigits) {
  const dvec3 eye(1e7, -1e7, 1e7), target = eye + dvec3(0, 0, -1);
  const View far = view(true, false, {1000, 1000}, eye, target),
             near = view(true, false, {1000, 1000}, {0, 0, 0}, {0, 0, -1});
  const dvec3 a = far.rays().at({500.5, 499.5}).along, b = near.rays().at({500.5, 499.5}).along;
  EXPECT_EQ(a, b);
  const glm::vec3 subtracted = glm::vec3(eye + b) - glm::vec3(eye);
  EXPECT_EQ(subtracted.x, 0) << "the naive way, in float";
  EXPECT_GT(b.x, 3e-4);
}

Buffer camera() {
  auto c = std::make_shared<Camera>();
  c->eye = {3, 2, 5}, c->resolution = {37, 23};
  return Buffer(std::shared_ptr<const Camera>(std::move(c)));
}

TEST(TraceCamera, KeepsTheLawOfTilesWithAndWithoutSamples) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 2, pattern->x = {1024, 3072}, pattern->y = {2048, 512};
  const Buffer of(std::shared_ptr<const SamplePattern>(std::move(pattern)));
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    EXPECT_EQ(test::break_of_tile_law({nodes::trace_camera(), "{}", {{"camera", {camera()}}}, precision}),
              "");
    EXPECT_EQ(test::break_of_tile_law({nodes::trace_camera(),
                                       R"({ "projection": "orthographic" })",
                                       {{"camera", {camera()}}, {"pattern", {of}}},
                                       precision}),
              "");
  }
}

TEST(TraceCamera, SamplesLieWhereThePatternHasThem) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 2, pattern->x = {1024, 3072}, pattern->y = {2048, 512};
  const Raster rays =
      test::PixelRun(nodes::trace_camera(), "{}",
                     {{"camera", {camera()}},
                      {"pattern", {Buffer(std::shared_ptr<const SamplePattern>(std::move(pattern)))}}},
                     Precision::real_double)
          .whole();
  const auto number = [&](const char* plane, int sample, int x, int y) {
    return rays.value(*rays.frame().find(plane), sample, x, y);
  };
  for (const char* of : {"D.x", "D.y", "D.z"}) {
    const std::string by_x = std::string(of, 1) + ".d" + of[2] + "_dx",
                      by_y = std::string(of, 1) + ".d" + of[2] + "_dy";
    EXPECT_NEAR(number(of, 1, 5, 7) - number(of, 0, 5, 7),
                0.5 * number(by_x.c_str(), 0, 5, 7) - 0.375 * number(by_y.c_str(), 0, 5, 7), 1e-15);
  }
}

}  // namespace
}  // namespace frustum
