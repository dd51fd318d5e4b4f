#include "nodes/project/view.h"

#include "nodes/kernels/camera.h"
#include "nodes/project.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<Camera> camera(glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up = {0, 1, 0}) {
  auto c = std::make_shared<Camera>();
  c->eye = eye, c->target = target, c->up = up;
  return c;
}

Ref<Mesh> seen(const Mesh& m, const Ref<Camera>& c, Context* ctx = nullptr) {
  return test::run_node(nodes::project_view(), Json::object(), {{test::shared(m)}, {c}}, ctx)
      .at(0)
      .as<Mesh>();
}

TEST(ProjectView, PutsTheEyeAtTheOriginAndTheTargetAhead) {
  const auto m =
      test::mesh_of(std::vector<glm::vec3>{{4, 0, 0}, {0, 0, 0}, {4, 1, 0}, {4, 0, -1}}, {}, Space::world);
  const auto out = seen(m, camera({4, 0, 0}, {0, 0, 0}));
  EXPECT_EQ(test::column<glm::vec3>(*out, "position"),
            (std::vector<glm::vec3>{{0, 0, 0}, {0, 0, -4}, {0, 1, 0}, {1, 0, 0}}));
  EXPECT_EQ(out->space(), Space::eye);
  EXPECT_NE(out->camera, nullptr);
}

TEST(ProjectView, KeepsTheWorldPositionAndSharesTheRest) {
  const Mesh m = test::torus(8, 6);
  const auto out = seen(m, camera({4, 3, 6}, {0, 1, 0}));
  EXPECT_EQ(out->at("world").data(), m.at("position").data());
  EXPECT_EQ(out->at("world").space(), Space::world);
  EXPECT_EQ(out->at("normal").data(), m.at("normal").data());
  EXPECT_EQ(out->at("triangle").data(), m.at("triangle").data());
  EXPECT_EQ(out->validate(), "");
}

// Distances between points survive: the map is rigid. Far from the origin, too, since the eye is subtracted first.
TEST(ProjectView, KeepsDistancesFarFromTheOrigin) {
  test::Random random(1);
  std::vector<glm::vec3> points;
  const glm::vec3 far_off(1e6F, 2e6F, -3e6F);
  for (int i = 0; i < 1000; ++i)
    points.push_back(far_off +
                     glm::vec3(random.uniform(-8, 8), random.uniform(-8, 8), random.uniform(-8, 8)));
  const auto out = seen(test::mesh_of(points, {}, Space::world),
                        camera(glm::dvec3(far_off) + glm::dvec3(3, 4, 5), far_off));
  const auto p = test::column<glm::vec3>(*out, "position");
  const auto view =
      kernels::look_at(glm::dvec3(far_off) + glm::dvec3(3, 4, 5), far_off, {0, 1, 0}).eye_from_world;
  const glm::mat3 turn(view.linear);
  const glm::vec3 shift(view.translation);
  double plain_worst = 0;
  for (std::size_t i = 1; i < p.size(); ++i) {
    const double want = kernels::norm(glm::dvec3(points[i]) - glm::dvec3(points[i - 1]));
    EXPECT_NEAR(kernels::norm(glm::dvec3(p[i]) - glm::dvec3(p[i - 1])), want, 16 * 0x1p-24 * 30);
    const glm::vec3 a = turn * points[i] + shift, b = turn * points[i - 1] + shift;
    plain_worst = std::max(plain_worst, std::fabs(kernels::norm(glm::dvec3(a) - glm::dvec3(b)) - want));
  }
  EXPECT_GT(plain_worst, 0.05);  // the plain form, R p + t in float
}

TEST(ProjectView, ReportsWhatItReplacedInTheCamera) {
  Context parallel, nowhere, fine;
  const auto m = test::mesh_of(std::vector<glm::vec3>{{0, 0, -1}}, {}, Space::object);
  const auto down = seen(m, camera({0, 5, 0}, {0, 0, 0}), &parallel);
  seen(m, camera({1, 1, 1}, {1, 1, 1}), &nowhere);
  seen(m, camera({1, 1, 1}, {0, 1, 1}), &fine);
  ASSERT_EQ(parallel.warnings().size(), 1U);
  EXPECT_EQ(parallel.warnings()[0].first, "camera_up_along_view");
  EXPECT_EQ(test::column<glm::vec3>(*down, "position")[0], glm::vec3(0, 1, -5));
  ASSERT_EQ(nowhere.warnings().size(), 1U);
  EXPECT_EQ(nowhere.warnings()[0].first, "camera_without_direction");
  EXPECT_TRUE(fine.warnings().empty());
}

TEST(ProjectView, PassesEmptyMeshesAndNaNOn) {
  EXPECT_EQ(
      seen(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::world), camera({0, 0, 5}, {}))->vertices(), 0U);
  const auto bad = test::mesh_of(std::vector<glm::vec3>{{std::nanf(""), 0, 0}}, {}, Space::world);
  EXPECT_GT(seen(bad, camera({0, 0, 5}, {}))->at("position").health().nan, 0U);
}

TEST(ProjectView, RefusesDoublePositionsInSingle) {
  const auto wide = test::mesh_of(std::vector<glm::dvec3>{{0, 0, 0}}, {}, Space::world);
  EXPECT_EQ(
      test::run_error(nodes::project_view(), Json::object(), {{test::shared(wide)}, {camera({0, 0, 5}, {})}})
          .first,
      "narrowing");
  Context ctx;
  ctx.precision = Precision::real_double;
  EXPECT_EQ(test::column<glm::dvec3>(*seen(wide, camera({0, 0, 5}, {}), &ctx), "position")[0],
            glm::dvec3(0, 0, -5));
}

}  // namespace
}  // namespace frustum
