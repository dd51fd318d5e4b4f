#include "nodes/trace/refract.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

namespace frustum {
namespace {

using glm::dvec3;
using kernels::RayBeam, kernels::SurfacePoint;

constexpr dvec3 up(0, 1, 0);
dvec3 down_at(double angle) { return {std::sin(angle), -std::cos(angle), 0}; }

TEST(TraceRefract, KeepsSnellsLawAndTheWayBack) {
  std::mt19937 random(31);
  std::uniform_real_distribution<double> angle(0, std::numbers::pi / 2), eta(0.4, 2.5);
  int total = 0;
  for (int i = 0; i < 2000; ++i) {
    const double in = angle(random), e = eta(random);
    const trace::Refraction r = trace::refracted(down_at(in), up, e);
    total += r.total;
    if (r.total) continue;
    EXPECT_NEAR(glm::length(r.along), 1, 4e-16);
    EXPECT_NEAR(r.along.x, e * std::sin(in), 4e-16) << "n1 sin i = n2 sin t";
    EXPECT_GE(r.reflectance, 0);
    EXPECT_LE(r.reflectance, 1);
    const trace::Refraction back = trace::refracted(-r.along, -up, 1 / e);
    if (back.total) continue;  // within rounding of the critical angle
    EXPECT_LT(glm::length(back.along + down_at(in)), 1e-15 / (1e-3 + std::cos(in)));
    EXPECT_NEAR(back.reflectance, r.reflectance, 1e-10);
  }
  EXPECT_GT(total, 100);
}

// The course's figures, row 78: 1.5 to 1 is total from 41.8103148958 degrees on; at normal incidence 0.04 is mirrored.
TEST(TraceRefract, CriticalAngleAndNormalIncidenceOfGlass) {
  const double critical = 41.8103148958 * std::numbers::pi / 180;
  EXPECT_FALSE(trace::refracted(down_at(critical - 1e-11), up, 1.5).total);
  EXPECT_TRUE(trace::refracted(down_at(critical + 1e-11), up, 1.5).total);
  EXPECT_EQ(trace::refracted(down_at(critical + 1e-3), up, 1.5).reflectance, 1);
  EXPECT_NEAR(trace::refracted(down_at(0), up, 1.5).reflectance, 0.04, 1e-16);
  EXPECT_NEAR(trace::refracted(down_at(0), up, 1 / 1.5).reflectance, 0.04, 1e-16);
  EXPECT_NEAR(trace::refracted({1, 0, 0}, up, 1 / 1.5).reflectance, 1, 1e-15) << "grazing";
  // Brewster's angle: what is mirrored is polarised across alone, ((n^2 - 1) / (n^2 + 1))^2 / 2 of the light.
  const double brewster = std::atan(1.5), across = (1.5 * 1.5 - 1) / (1.5 * 1.5 + 1);
  EXPECT_NEAR(trace::refracted(down_at(brewster), up, 1 / 1.5).reflectance, across * across / 2, 1e-15);
}

// Hard case RAY-17: near the critical angle 1 - eta^2 (1 - c^2) cancels twice, and in float takes light that gets through
// for light that is all mirrored, and the other way round. Judged in long double, of the directions as they are in float.
TEST(TraceRefract, DecidesTheSideNearTheCriticalAngle) {
  std::mt19937 random(37);
  std::uniform_real_distribution<float> index(1.05F, 2.05F);
  std::uniform_int_distribution<int> ulps(-4, 4);
  int wrong = 0, naive = 0, cases = 0;
  for (int i = 0; i < 20000; ++i) {
    const float eta = index(random), critical = std::sqrt(1 - 1 / (eta * eta));
    float c = critical;
    for (int k = ulps(random); k != 0; k += k < 0 ? 1 : -1) c = std::nextafter(c, k < 0 ? 0.0F : 1.0F);
    const glm::vec3 d(std::sqrt(1 - c * c), -c, 0);
    const long double x = d.x, y = d.y, s = eta * x / std::sqrt(x * x + y * y);
    if (std::fabs(static_cast<double>(s - 1)) < 8 * 0x1p-53) continue;  // not to be told in double
    ++cases;
    wrong += trace::refracted(glm::normalize(dvec3(d)), up, eta).total != (s > 1);
    naive += (1 - eta * eta * (1 - c * c) < 0) != (s > 1);
  }
  EXPECT_GT(cases, 19000);
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(naive, cases / 20) << "the form that cancels twice";
}

// Hard case RAY-20: nothing happens at a surface between two media that are the same, and almost nothing at 1 +- 1e-7.
TEST(TraceRefract, IndexMatchedMediaDoNotBend) {
  for (const double in : {0.0, 0.3, 1.2, 1.5})
    for (const double off : {0.0, 1e-7, -1e-7, 1e-4}) {
      const trace::Refraction r = trace::refracted(down_at(in), up, 1 + off);
      ASSERT_FALSE(r.total);
      const double bend = std::fabs(off) * std::tan(in);
      EXPECT_LT(glm::length(r.along - down_at(in)), 1.1 * bend + 1e-15 / std::cos(in)) << in << ' ' << off;
      EXPECT_LT(r.reflectance, 1e-3);
    }
}

// Hard case RAY-21: through a stack of panes light leaves as it came.
TEST(TraceRefract, AThousandPanesLeaveTheDirection) {
  for (const double in : {0.1, 0.7, 1.3, 89.0 * std::numbers::pi / 180}) {
    RayBeam beam{.along = down_at(in)};
    for (int pane = 0; pane < 1000; ++pane) {
      beam = *trace::bent(beam, {.n = up, .face_normal = up}, 1, 1.5).beam;
      beam = *trace::bent(beam, {.n = -up, .face_normal = -up}, 1, 1.5).beam;
    }
    EXPECT_LT(glm::length(beam.along - down_at(in)), 1e-12) << in;
  }
}

// A ball of glass gathers light that falls on it along an axis at n R / (2 (n - 1)) from its middle.
TEST(TraceRefract, ABallOfGlassHasItsFocus) {
  const double n = 1.5, height = 1e-4;
  RayBeam beam{.origin = {height, 0, 5}, .along = {0, 0, -2}};
  for (int surface = 0; surface < 2; ++surface) {
    const double b = glm::dot(beam.origin, beam.along), a = glm::dot(beam.along, beam.along),
                 c = glm::dot(beam.origin, beam.origin) - 1, root = std::sqrt(b * b - a * c);
    const dvec3 p = beam.origin + (surface == 0 ? -b - root : -b + root) / a * beam.along;
    beam = *trace::bent(beam, {.p = p, .n = p, .face_normal = p}, 1, n).beam;
    EXPECT_NEAR(glm::length(beam.along), 2, 1e-15) << "it goes on with its length";
  }
  const double t = -beam.origin.x / beam.along.x;
  EXPECT_NEAR((beam.origin + t * beam.along).z, -n / (2 * (n - 1)), 1e-7);
}

TEST(TraceRefract, ChangesAsTheRaysBesideDo) {
  const auto on_ball = [](const dvec3& o, const dvec3& d) {
    const double b = glm::dot(o, d), c = glm::dot(o, o) - 1, a = glm::dot(d, d);
    return o + (-b - std::sqrt(b * b - a * c)) / a * d;
  };
  const dvec3 o(0, 0, 5), d(0.1, -0.05, -1), dd(0.01, 0.002, 0);
  const double h = 1e-5;
  const auto beam_at = [&](double x) {
    const dvec3 p = on_ball(o, d + x * dd);
    return trace::bent({.origin = o, .along = d + x * dd}, {.p = p, .n = p * 3.0, .face_normal = p}, 1, 1.5)
        .beam->along;
  };
  const dvec3 p = on_ball(o, d), p_dx = (on_ball(o, d + h * dd) - on_ball(o, d - h * dd)) / (2 * h);
  const auto out =
      trace::bent({.origin = o, .along = d, .along_dx = dd},
                  {.p = p, .p_dx = p_dx, .n = p * 3.0, .n_dx = p_dx * 3.0, .face_normal = p}, 1, 1.5);
  const dvec3 expected = (beam_at(h) - beam_at(-h)) / (2 * h);
  EXPECT_LT(glm::length(out.beam->along_dx - expected), 1e-6 * glm::length(expected));
}

TEST(TraceRefract, NothingPassesWithoutANormalOrAWay) {
  EXPECT_FALSE(trace::bent({.along = {0, -1, 0}}, {}, 1, 1.5).beam);
  EXPECT_FALSE(trace::bent({}, {.n = up, .face_normal = up}, 1, 1.5).beam);
  const trace::Bent all = trace::bent({.along = down_at(-1.2)}, {.n = -up, .face_normal = -up}, 1, 1.5);
  EXPECT_FALSE(all.beam);
  EXPECT_EQ(all.reflectance, 1);
}

}  // namespace
}  // namespace frustum
