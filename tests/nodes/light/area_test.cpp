// light.area: its points, and the light they give against Lambert's closed form.
#include "nodes/light/area.h"
#include "nodes/kernels/lamp_pieces.h"
#include "nodes/light.h"
#include "nodes/shade.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/visible_lights.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace frustum {
namespace {

using glm::dvec3;

Ref<LightSet> area(const std::string& params) {
  return test::run_geometry(nodes::light_area(), params, {}).at(0).as<LightSet>();
}

// Irradiance / pi at p of a polygon of radiance 1 that lies wholly above the plane of n: Lambert 1760. In long double, and
// with atan2 for angles (hard case RAD-04).
double lambert(const std::vector<dvec3>& polygon, const dvec3& p, const dvec3& n) {
  using Long = glm::vec<3, long double>;
  const auto dot = [](const Long& a, const Long& b) { return a.x * b.x + a.y * b.y + a.z * b.z; };
  const auto cross = [](const Long& a, const Long& b) {
    return Long(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
  };
  long double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Long a(polygon[i] - p), b(polygon[(i + 1) % polygon.size()] - p), side = cross(a, b);
    const long double length = std::sqrt(dot(side, side));
    sum += std::atan2(length, dot(a, b)) * dot(side, Long(n)) / length;
  }
  return static_cast<double>(std::fabs(sum) / (2 * std::numbers::pi_v<long double>));
}

struct Lamp {
  dvec3 centre, u, v;
  std::vector<dvec3> polygon() const {
    return {centre - (u + v) * 0.5, centre + (u - v) * 0.5, centre + (u + v) * 0.5, centre + (v - u) * 0.5};
  }
  double sampled(std::uint32_t n, const dvec3& p, const dvec3& normal) const {
    const Ref<LightSet> set = one_light({.kind = Light::Kind::area,
                                         .color = dvec3(1),
                                         .position = centre,
                                         .edge_u = u,
                                         .edge_v = v,
                                         .samples = n});
    const auto sources = light_sources({&set, 1});
    EXPECT_EQ(sources.size(), n);
    const kernels::LightSetup<double> setup{
        sources, {}, kernels::Highlight::none, kernels::Exponent<double>(1)};
    return kernels::receive(setup, {normal.x, normal.y, normal.z}, {p.x, p.y, p.z}).diffuse[0];
  }
};

const Lamp lamp{{0.4, 3, -0.3}, {2, 0, 0}, {0, 0, 1.5}};

TEST(LightArea, PointsConvergeToLambertsFormulaLikeOneOverTheirNumber) {
  for (const dvec3& p : {dvec3(0, 0, 0), dvec3(1.5, 0.5, 1), dvec3(-3, 1, 2), dvec3(0.4, 2, -0.3)})
    for (const dvec3& n : {dvec3(0, 1, 0), dvec3(0.36, 0.8, 0.48)}) {
      bool above = true;
      for (const dvec3& corner : lamp.polygon()) above = above && kernels::dot(n, corner - p) > 0;
      if (!above) continue;
      const double want = lambert(lamp.polygon(), p, n);
      ASSERT_GT(want, 0.001);
      double last = 1;
      for (const std::uint32_t samples : {4u, 16u, 64u, 256u, 1024u}) {
        const double off = std::fabs(lamp.sampled(samples, p, n) - want) / want;
        EXPECT_LT(off, 1.5 / samples) << p.x << " " << n.x << " " << samples;
        last = off;
      }
      EXPECT_LT(last, 5e-4);
    }
}

// A far lamp is a point of its area, seen at the cosine of its own slant: without that cosine it is too bright.
TEST(LightArea, AFarLampIsAsBrightAsItsAreaSeenAtItsSlant) {
  const dvec3 p(40, -50, 0), to = lamp.centre - p;
  const double d2 = kernels::dot(to, to);
  const dvec3 n = kernels::normalized(to).value();
  const double cosine = to.y / std::sqrt(d2);
  EXPECT_NEAR(lamp.sampled(16, p, n) / (3.0 * cosine / (std::numbers::pi * d2)), 1, 2e-3);
  EXPECT_GT(1 / cosine, 1.1) << "the form without the cosine fails here";
}

TEST(LightArea, ShinesToOneSideAndGivesNothingOnItself) {
  EXPECT_EQ(lamp.sampled(16, {0.4, 5, -0.3}, {0, -1, 0}), 0) << "behind it";
  EXPECT_EQ(lamp.sampled(16, {3, 3, 0}, {0, 1, 0}), 0) << "in its plane";
  for (std::uint32_t i = 0; i < 4; ++i) {
    const kernels::LampPieces pieces(lamp.centre, lamp.u, lamp.v, 4);
    EXPECT_TRUE(std::isfinite(lamp.sampled(4, pieces.point(i), {0, 1, 0}))) << "on one of its points";
  }
}

TEST(LightArea, EachStratumHoldsOnePoint) {
  for (const std::uint32_t n : {1u, 4u, 16u, 64u, 256u}) {
    const auto edge = static_cast<int>(std::lround(std::sqrt(n)));
    const kernels::LampPieces pieces({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, n);
    std::set<std::pair<int, int>> strata;
    dvec3 sum(0);
    for (std::uint32_t i = 0; i < n; ++i) {
      const dvec3 p = pieces.point(i);
      strata.emplace(static_cast<int>((p.x + 0.5) * edge), static_cast<int>((p.z + 0.5) * edge));
      sum += p;
      EXPECT_TRUE(std::fabs(p.x) < 0.5 && std::fabs(p.z) < 0.5 && p.y == 0);
    }
    EXPECT_EQ(strata.size(), n);
    EXPECT_LT(kernels::norm(sum), 1e-12) << "their middle is the lamp's";
  }
}

TEST(LightArea, WhatIsNoRectangleIsRefused) {
  const auto code = [](const std::string& params) {
    try {
      area(params);
    } catch (const NodeError& e) {
      return e.code + " " + e.part;
    }
    return std::string("none");
  };
  EXPECT_EQ(code("{}"), "none");
  EXPECT_EQ(code(R"({"edge_u": [0, 0, 0]})"), "no_area /params/edge_u");
  EXPECT_EQ(code(R"({"edge_v": [0.5, 0, 1]})"), "no_rectangle /params/edge_v");
  EXPECT_EQ(area(R"({"samples": 9})")->lights.at(0).samples, 9u);
}

}  // namespace
}  // namespace frustum
