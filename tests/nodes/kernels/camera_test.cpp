#include "nodes/kernels/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <set>
#include <vector>

#include "tests/support/clip_spaces.h"
#include "tests/support/ulps.h"

namespace frustum {
namespace {

using kernels::LookAtFault;
using test::Random;
using test::ulps;

constexpr double u = 0x1p-53;
constexpr double inf = std::numeric_limits<double>::infinity();

double off_orthonormal(const kernels::Affine& a) {
  using Long = glm::mat<3, 3, long double>;
  const Long m = Long(a.linear) * Long(a.inverse_linear);
  long double worst = 0;
  for (glm::length_t c = 0; c < 3; ++c)
    for (glm::length_t r = 0; r < 3; ++r) worst = std::max(worst, std::fabs(m[c][r] - (r == c ? 1 : 0)));
  return static_cast<double>(worst);
}

TEST(LookAt, PutsTheTargetOnTheNegativeZAxis) {
  const auto [view, fault] = kernels::look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
  EXPECT_EQ(fault, LookAtFault::none);
  EXPECT_EQ(view.linear, glm::dmat3(1.0));
  EXPECT_EQ(view.translation, glm::dvec3(0, 0, -5));
  const auto side = kernels::look_at({4, 0, 0}, {0, 0, 0}, {0, 2, 0}).eye_from_world;
  EXPECT_EQ(side.linear * glm::dvec3(0, 0, -1) + side.translation, glm::dvec3(1, 0, -4));
  EXPECT_EQ(side.inverse_translation, glm::dvec3(4, 0, 0));
}

// XFM-12.
TEST(LookAt, IsOrthonormalForEveryDirection) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const glm::dvec3 eye(random.magnitude(-9, 9), random.magnitude(-9, 9), random.magnitude(-9, 9));
    glm::dvec3 target(random.magnitude(-9, 9), random.magnitude(-9, 9), random.magnitude(-9, 9));
    if (i % 2 == 0) target = eye + glm::dvec3(random.magnitude(-30, -20), 1, random.magnitude(-30, -20));
    const auto [view, fault] = kernels::look_at(eye, target, {0, 1, 0});
    EXPECT_LE(off_orthonormal(view), 10 * u);
    EXPECT_EQ(fault, LookAtFault::none);
    EXPECT_GE(view.linear[1][1], 0) << "up points up";
  }
}

TEST(LookAt, HasADefinedFallback) {
  const auto down = kernels::look_at({0, 5, 0}, {0, 0, 0}, {0, 1, 0});
  EXPECT_EQ(down.fault, LookAtFault::up_along_direction);
  EXPECT_EQ(down.eye_from_world.linear * glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0));  // north is up
  EXPECT_EQ(down.eye_from_world.linear * glm::dvec3(1, 0, 0), glm::dvec3(1, 0, 0));   // east is right
  const auto along_z = kernels::look_at({0, 0, 1}, {0, 0, 0}, {0, 0, 3});
  EXPECT_EQ(along_z.fault, LookAtFault::up_along_direction);
  EXPECT_EQ(along_z.eye_from_world.linear, glm::dmat3(1.0));
  EXPECT_EQ(kernels::look_at({1, 2, 3}, {1, 2, 3}, {0, 1, 0}).fault, LookAtFault::no_direction);
  EXPECT_EQ(kernels::look_at({0, 0, 1}, {0, 0, 0}, {0, 0, 0}).fault, LookAtFault::up_along_direction);
  const auto undefined = kernels::look_at({0, 0, 0}, {std::nan(""), 0, 0}, {0, 1, 0});
  EXPECT_EQ(undefined.fault, LookAtFault::no_direction);
  EXPECT_LE(off_orthonormal(undefined.eye_from_world), 8 * u);
  EXPECT_TRUE(
      std::isnan(glm::lookAt(glm::vec3(0), glm::vec3(0, 5, 0), glm::vec3(0, 1, 0))[0][0]));  // the plain form
}

TEST(Perspective, IsOpenGlsMatrix) {
  const double fov = 0.7, aspect = 1.6;
  const auto p = kernels::matrix_of(kernels::perspective(fov, aspect, 0.1, 50));
  const glm::dmat4 peer = glm::perspective(fov, aspect, 0.1, 50.0);
  for (glm::length_t c = 0; c < 4; ++c)
    for (glm::length_t r = 0; r < 4; ++r)
      EXPECT_NEAR(p[c][r], peer[c][r], 8 * u * (1 + std::fabs(peer[c][r])));
}

// Row 20 of the checklist, and PRJ-06: near and far go to the ends, for thin and for deep volumes alike.
TEST(Projections, MapTheEndsOfTheVolume) {
  for (const auto& [near_z, far_z] : {std::pair{0.1, 100.0}, {1e-3, 1e6}, {1e6, 1e6 + 1}, {1e-4, 1e8}})
    for (const kernels::ClipSpace space : test::clip_spaces) {
      const double at_near = kernels::near_depth(space.depth), at_far = kernels::far_depth(space.depth);
      const double slack = 4 * u * far_z / (far_z - near_z), up = space.y_down ? -1 : 1;
      const auto p = kernels::perspective(1, 1, near_z, far_z, space);
      const kernels::ClipMap<double> clip(p);
      EXPECT_NEAR(kernels::divided(clip({0, 0, -near_z})).z, at_near, slack);
      EXPECT_NEAR(kernels::divided(clip({0, 0, -far_z})).z, at_far, slack);
      const double edge = std::tan(0.5) * near_z;
      EXPECT_NEAR(kernels::divided(clip({edge, -edge, -near_z})).x, 1, 4 * u);
      EXPECT_NEAR(kernels::divided(clip({edge, edge, -near_z})).y, up, 4 * u);
      const auto o = kernels::orthographic(4, 2, near_z, far_z, space);
      EXPECT_NEAR(kernels::ClipMap<double>(o)({4, -2, -near_z}).z, at_near, 2 * slack);
      EXPECT_NEAR(kernels::ClipMap<double>(o)({4, -2, -far_z}).z, at_far, 2 * slack);
      EXPECT_EQ(kernels::ClipMap<double>(o)({4, -2, -far_z}).x, 1);
      EXPECT_EQ(kernels::ClipMap<double>(o)({4, -2, -far_z}).y, -up);
    }
  const auto infinite = kernels::perspective(1, 1, 0.5, inf, {.depth = kernels::DepthRange::one_to_zero});
  EXPECT_EQ(kernels::divided(kernels::ClipMap<double>(infinite)({0, 0, -0.5})).z, 1);
  EXPECT_EQ(kernels::divided(kernels::ClipMap<double>(infinite)({0, 0, -1e300})).z, 5e-301);
  const auto standard = kernels::perspective(1, 1, 0.5, inf);
  EXPECT_EQ(kernels::divided(kernels::ClipMap<double>(standard)({0, 0, -0.5})).z, -1);
  const auto from_zero = kernels::perspective(1, 1, 0.5, inf, {.depth = kernels::DepthRange::zero_to_one});
  EXPECT_EQ(kernels::divided(kernels::ClipMap<double>(from_zero)({0, 0, -0.5})).z, 0);
  EXPECT_EQ(kernels::divided(kernels::ClipMap<double>(from_zero)({0, 0, -1e300})).z, 1);
}

// What each convention says in its own words: D3DXMatrixPerspectiveFovRH for a depth from 0 to 1.
TEST(Perspective, FromZeroToOneIsDirect3DsMatrix) {
  const double fov = 0.7, aspect = 1.6, n = 0.1, f = 50;
  const auto d3d = kernels::matrix_of(
      kernels::perspective(fov, aspect, n, f, {.depth = kernels::DepthRange::zero_to_one}));
  const auto vulkan = kernels::matrix_of(
      kernels::perspective(fov, aspect, n, f, {.depth = kernels::DepthRange::zero_to_one, .y_down = true}));
  const double y = 1 / std::tan(fov / 2);
  EXPECT_NEAR(d3d[0][0], y / aspect, 4 * u);
  EXPECT_NEAR(d3d[1][1], y, 8 * u);
  EXPECT_NEAR(d3d[2][2], f / (n - f), 4 * u);
  EXPECT_NEAR(d3d[3][2], n * f / (n - f), u);
  EXPECT_EQ(vulkan[1][1], -d3d[1][1]);
  for (const auto& [column, row] : {std::pair{0, 0}, {2, 2}, {3, 2}, {2, 3}})
    EXPECT_EQ(vulkan[column][row], d3d[column][row]);
}

// PRJ-04: 100 000 planes between 1000 and 1001 behind a near plane at 1e-3.
TEST(ReversedDepth, TellsDistancesApartThatStandardDepthMerges) {
  const kernels::ClipMap<float> standard(kernels::perspective(1, 1, 1e-3, 1e6));
  const kernels::ClipMap<float> reversed(
      kernels::perspective(1, 1, 1e-3, 1e6, {.depth = kernels::DepthRange::one_to_zero}));
  std::set<float> a, b;
  float before = 2;
  for (int i = 0; i < 100000; ++i) {
    const float z = -1000 - static_cast<float>(i) * 1e-5F;
    a.insert(kernels::divided(standard({0, 0, z})).z);
    const float depth = kernels::divided(reversed({0, 0, z})).z;
    b.insert(depth);
    EXPECT_LE(depth, before);
    before = depth;
  }
  EXPECT_LE(a.size(), 3U);
  EXPECT_GT(b.size(), 5000U);
}

// PRJ-12: the digits that depth still has come back; nothing blows up.
TEST(EyeFromNdc, InvertsTheProjectionInClosedForm) {
  Random random(2);
  for (const kernels::ClipSpace space : test::clip_spaces)
    for (int i = 0; i < 10000; ++i) {
      const auto p = kernels::perspective(1, 1.5, 1e-3, 1e6, space);
      const double z = std::fabs(random.magnitude(3, 16));
      const glm::dvec3 eye(random.uniform(-1, 1) * z, random.uniform(-1, 1) * z, -z);
      const auto back = kernels::eye_from_ndc(p, kernels::divided(kernels::ClipMap<double>(p)(eye)));
      // Standard depth has absolute resolution u near 1: relative error z / near * u.
      const double allowed = kernels::is_reversed(space.depth) ? 8 * u : 4 * u * (2 + z / 1e-3);
      EXPECT_LE(std::fabs(back.z - eye.z), allowed * z);
      EXPECT_LE(std::fabs(back.x - eye.x), (allowed + 4 * u) * z);
      EXPECT_LE(std::fabs(back.y - eye.y), (allowed + 4 * u) * z);
    }
  const auto o = kernels::orthographic(3, 2, -1, 9);
  EXPECT_EQ(kernels::eye_from_ndc(o, kernels::divided(kernels::ClipMap<double>(o)({1.5, 0.75, -4}))),
            glm::dvec3(1.5, 0.75, -4));
}

TEST(FrustumPlanes, HoldWhatTheProjectionKeeps) {
  Random random(3);
  const auto view = kernels::look_at({3, 2, 6}, {0, 1, 0}, {0, 1, 0}).eye_from_world;
  std::vector<kernels::Projection> all;
  for (const kernels::ClipSpace space : test::clip_spaces) {
    all.push_back(kernels::perspective(0.8, 1.5, 1, 20, space));
    all.push_back(kernels::orthographic(5, 1.5, 1, 20, space));
  }
  for (const auto& p : all) {
    const auto planes = kernels::frustum_planes(p, view);
    int inside = 0;
    for (int i = 0; i < 20000; ++i) {
      const glm::dvec3 world(random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-20, 20));
      const auto clip = kernels::ClipMap<double>(p)(kernels::PointMap<double>(view)(world));
      const auto side = kernels::clip_planes(p.space);
      bool kept = true;
      for (std::size_t k = 0; k < 6; ++k) {
        const double a = kernels::dot(planes[k], glm::dvec4(world, 1)), b = kernels::dot(side[k], clip);
        EXPECT_NEAR(a, b, 64 * u * 40);
        kept = kept && b >= 0;
      }
      inside += kept ? 1 : 0;
    }
    EXPECT_GT(inside, 100);
  }
}

// PRJ-09: every pixel centre of a row of 16384 comes back within the half step of 2^-8 px snapping.
TEST(Viewport, ReturnsPixelCentres) {
  const kernels::Viewport viewport({16384, 1});
  for (int k = 0; k < 16384; ++k) {
    const auto ndc = static_cast<float>(2 * (k + 0.5) / 16384 - 1);
    const float px = viewport.x_px(ndc);
    EXPECT_EQ(std::nearbyint(static_cast<double>(px) * 256), (k + 0.5) * 256);
  }
  EXPECT_EQ(viewport.x_px(-1.0F), 0);
  EXPECT_EQ(viewport.x_px(1.0F), 16384);
  EXPECT_EQ(viewport.y_px(1.0), 0);  // y down
  EXPECT_EQ(viewport.y_px(-1.0), 1);
  EXPECT_EQ(viewport.x_px(0.0), 8192);
  EXPECT_EQ(kernels::Viewport({7, 5}).ndc_from_px({3.5, 2.5}), glm::dvec2(0, 0));
  const kernels::Viewport down({16, 9}, true), up({16, 9});
  EXPECT_EQ(down.y_px(-1.0), 0);
  for (const float y : {-1.0F, -0.3F, 1e-7F, 0.7F, 1.0F}) EXPECT_EQ(down.y_px(-y), up.y_px(y));
  EXPECT_EQ(down.ndc_from_px({3, 2}).y, -up.ndc_from_px({3, 2}).y);
}

// PRJ-02: 1/w overflows, x/w does not.
TEST(Divide, HoldsForTinyW) {
  EXPECT_EQ(kernels::divided(glm::vec4(1e-39F, -1e-39F, 0, 1e-39F)), glm::vec3(1, -1, 0));
  EXPECT_TRUE(std::isinf(1 / 1e-39F));  // the plain form
  EXPECT_EQ(kernels::divided(glm::dvec4(3, 2, 1, 4)), glm::dvec3(0.75, 0.5, 0.25));
}

}  // namespace
}  // namespace frustum
