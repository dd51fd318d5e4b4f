#include "nodes/project/mvp.h"

#include "nodes/project.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/value.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <random>

namespace frustum {
namespace {

Ref<Camera> a_camera() {
  Camera c;
  c.eye = {4, 3, 6}, c.target = {0.5, 1, -1}, c.resolution = {641, 480};
  return std::make_shared<const Camera>(c);
}

TEST(ProjectMvp, PutsPointsWhereTheStagesPutThem) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> in(-1, 1);
  std::vector<glm::vec<3, double>> p;
  for (int i = 0; i < 300; ++i) p.emplace_back(in(random), in(random), in(random));
  std::vector<glm::uvec3> faces;
  for (std::uint32_t i = 0; i < 100; ++i) faces.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  const auto camera = a_camera();
  for (const char* volume : {"perspective", "orthographic"}) {
    Context ctx;
    ctx.precision = Precision::real_double;
    Buffer mesh = test::shared(test::mesh_of(p, faces, Space::world));
    const bool deep = volume == std::string("perspective");
    const NodeType stages[] = {nodes::project_view(),
                               deep ? nodes::project_perspective() : nodes::project_orthographic(),
                               nodes::project_viewport()};
    for (const NodeType& stage : stages)
      mesh = test::run_node(stage, Json::object(), {{mesh}, {camera}}, &ctx).at(0);
    const auto out = test::run_node(nodes::project_mvp(), {{"volume", volume}}, {{camera}}, &ctx);
    const glm::dmat4 m = out.at(0).as<Matrix>()->value;
    for (std::uint32_t i = 0; i < 300; ++i) {
      const glm::dvec4 h = m * glm::dvec4(p[i], 1);
      const glm::dvec3 screen = glm::dvec3(h) / h.w, expected(test::position_at(*mesh.as<Mesh>(), i));
      EXPECT_NEAR(screen.x, expected.x, 1e-10);
      EXPECT_NEAR(screen.y, expected.y, 1e-10);
      EXPECT_NEAR(screen.z, expected.z, 1e-10);
    }
    // Errata E11: with the printed M_vp = M_O M_P the point stays in [-1, 1].
    const glm::dmat4 printed =
        out.at(2).as<Matrix>()->value * (out.at(2).as<Matrix>()->value * out.at(3).as<Matrix>()->value);
    const glm::dvec4 wrong = printed * glm::dvec4(p[0], 1);
    EXPECT_GT(std::fabs(wrong.x / wrong.w - test::position_at(*mesh.as<Mesh>(), 0).x), 1);
  }
}

TEST(ProjectMvp, ShowsEveryFactor) {
  glm::dmat4 model(1.0);
  model[3] = {1, 2, 3, 1};
  const auto out = test::run_node(nodes::project_mvp(), Json::object(),
                                  {{a_camera()}, {std::make_shared<const Matrix>(Matrix{model})}});
  const auto m = [&](std::size_t i) { return out.at(i).as<Matrix>()->value; };
  const glm::dmat4 product = m(1) * m(2) * m(3) * m(4);
  for (glm::length_t c = 0; c < 4; ++c)
    for (glm::length_t r = 0; r < 4; ++r) EXPECT_NEAR(product[c][r], m(0)[c][r], 1e-11);
  EXPECT_EQ(m(4), model);
  EXPECT_EQ(m(5)[3], glm::dvec4(4, 3, 6, 1)) << "M_cam places the eye";
  const glm::dmat4 identity = m(3) * m(5);
  for (glm::length_t c = 0; c < 4; ++c)
    for (glm::length_t r = 0; r < 4; ++r) EXPECT_NEAR(identity[c][r], c == r ? 1 : 0, 1e-14);
  EXPECT_EQ(m(1) * glm::dvec4(-1, 1, 0, 1), glm::dvec4(0, 0, 0, 1)) << "the top left corner";
  EXPECT_EQ(m(1) * glm::dvec4(1, -1, 0, 1), glm::dvec4(641, 480, 0, 1));
  EXPECT_THAT(out.at(6).as<Table>()->columns[0].texts,
              testing::ElementsAre("M_mod", "M_cam^-1", "M_proj", "M_vp", "M"));
  EXPECT_THAT(out.at(6).as<Table>()->columns[1].numbers, testing::Each(testing::Gt(0)));
}

TEST(ProjectMvp, RefusesACameraWithoutAVolume) {
  Camera c;
  c.near_z = 5, c.far_z = 5;
  EXPECT_EQ(
      test::run_error(nodes::project_mvp(), Json::object(), {{std::make_shared<const Camera>(c)}}).first,
      "impossible_camera");
}

}  // namespace
}  // namespace frustum
