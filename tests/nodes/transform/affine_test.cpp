#include "nodes/transform/affine.h"

#include "nodes/kernels/vector.h"
#include "nodes/transform.h"
#include "runtime/buffers/surface.h"
#include "runtime/buffers/value.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace frustum {
namespace {

using test::run_node;
using test::shared;

const std::vector<glm::vec3> corners = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
const std::vector<glm::uvec3> one_face = {{0, 1, 2}};

Ref<Mesh> mesh() { return shared(test::mesh_of(corners, one_face, Space::object)); }

Ref<Mesh> transformed(const Ref<Mesh>& m, const Json& steps, Context* ctx = nullptr) {
  return run_node(nodes::transform_affine(), {{"steps", steps}}, {{m}}, ctx).at(0).as<Mesh>();
}

std::vector<glm::vec3> positions(const Json& steps) {
  return test::column<glm::vec3>(*transformed(mesh(), steps), "position");
}

TEST(TransformAffine, MovesPointsByEachKindOfStep) {
  EXPECT_EQ(positions({{{"translate", {1, 2, 3}}}}),
            (std::vector<glm::vec3>{{2, 2, 3}, {1, 4, 3}, {1, 2, 6}}));
  EXPECT_EQ(positions({{{"rotate", {{"axis", {0, 0, 1}}, {"degrees", 90}}}}}),
            (std::vector<glm::vec3>{{0, 1, 0}, {-2, 0, 0}, {0, 0, 3}}));
  EXPECT_EQ(positions({{{"euler", {{"degrees", {90, 0, 90}}, {"order", "zyx"}}}}}),
            (std::vector<glm::vec3>{{0, 0, 1}, {-2, 0, 0}, {0, -3, 0}}));
  EXPECT_EQ(positions({{{"quaternion", {0, 0, 0, 2}}}}),
            (std::vector<glm::vec3>{{-1, 0, 0}, {0, -2, 0}, {0, 0, 3}}));
  EXPECT_EQ(positions({{{"scale", {2, 1, 0.5}}}}),
            (std::vector<glm::vec3>{{2, 0, 0}, {0, 2, 0}, {0, 0, 1.5}}));
  EXPECT_EQ(positions({{{"shear", {{"move", "x"}, {"by", "y"}, {"amount", 3}}}}}),
            (std::vector<glm::vec3>{{1, 0, 0}, {6, 2, 0}, {0, 0, 3}}));
  EXPECT_EQ(positions({{{"matrix", {{0, 1, 0, 5}, {1, 0, 0, 0}, {0, 0, -1, 0}, {0, 0, 0, 1}}}}}),
            (std::vector<glm::vec3>{{5, 1, 0}, {7, 0, 0}, {5, 0, -3}}));
}

TEST(TransformAffine, MakesStepsInTheirOrderAfterTheMatrix) {
  const Json turn = {{"rotate", {{"axis", {0, 0, 1}}, {"degrees", 90}}}}, move = {{"translate", {1, 0, 0}}};
  EXPECT_EQ(positions({turn, move})[0], glm::vec3(1, 1, 0));
  EXPECT_EQ(positions({move, turn})[0], glm::vec3(0, 2, 0));
  auto scale = std::make_shared<Matrix>();
  scale->value = glm::dmat4(2.0);
  scale->value[3][3] = 1;
  const auto out = run_node(nodes::transform_affine(), {{"steps", {move}}}, {{mesh()}, {Ref<Matrix>(scale)}});
  EXPECT_EQ(test::column<glm::vec3>(*out.at(0).as<Mesh>(), "position")[0], glm::vec3(3, 0, 0));
  EXPECT_EQ(out.at(1).as<Matrix>()->value[3], glm::dvec4(1, 0, 0, 1));
  EXPECT_EQ(out.at(1).as<Matrix>()->value[0], glm::dvec4(2, 0, 0, 0));
}

// XFM-09: four quarter turns bring every bit back.
TEST(TransformAffine, ReturnsEveryBitAfterFourQuarterTurns) {
  const auto torus = shared(test::torus(31, 17, Space::object));
  const Json turn = {{"rotate", {{"axis", {0, 1, 0}}, {"degrees", 90}}}};
  auto m = torus;
  for (int i = 0; i < 4; ++i) m = transformed(m, Json::array({turn}));
  EXPECT_EQ(test::column<glm::vec3>(*m, "position"), test::column<glm::vec3>(*torus, "position"));
}

TEST(TransformAffine, KeepsNormalsPerpendicularAndOfUnitLength) {
  const auto m = transformed(shared(test::torus(20, 12, Space::object)),
                             {{{"scale", {1e-6, 3, 1e4}}}, {{"shear", {{"amount", 2}}}}});
  const auto p = test::column<glm::vec3>(*m, "position"), n = test::column<glm::vec3>(*m, "normal");
  const auto plain = test::column<glm::vec3>(test::torus(20, 12), "normal");
  for (std::size_t i = 0; i < n.size(); ++i) {
    EXPECT_NEAR(kernels::norm(n[i]), 1, 0x1p-22);
    // In exact arithmetic: S^-T n with S = shear scale, normalised.
    const glm::dvec3 s(plain[i].x / 1e-6, plain[i].y / 3.0, plain[i].z / 1e4);
    const auto want = *kernels::normalized(glm::dvec3(s.x, s.y - 2 * s.x, s.z));
    EXPECT_LE(kernels::norm(glm::dvec3(n[i]) - want), 4e-7);
  }
  EXPECT_EQ(p.size(), n.size());
}

TEST(TransformAffine, TurnsMirroredFacesSoThatFrontsStayFronts) {
  Mesh m = test::mesh_of(corners, one_face, Space::object);
  m.columns.push_back(Column::make<float>("heat", Domain::corner, std::vector<float>{1, 2, 3}));
  const auto out = transformed(shared(m), {{{"scale", {-1, 1, 1}}}});
  EXPECT_EQ(test::column<glm::uvec3>(*out, "triangle")[0], glm::uvec3(0, 2, 1));
  EXPECT_EQ(test::column<float>(*out, "heat"), (std::vector<float>{1, 3, 2}));
  const auto twice = transformed(shared(m), {{{"scale", {-1, -1, 1}}}});
  EXPECT_EQ(test::column<glm::uvec3>(*twice, "triangle")[0], glm::uvec3(0, 1, 2));
}

TEST(TransformAffine, GivesASurfaceForASurface) {
  auto s = std::make_shared<Surface>();
  for (int i = 0; i < 16; ++i) s->points.emplace_back(i / 4, i % 4, 0);
  s->patches.push_back({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15});
  const Json mirror = {{"steps", {{{"scale", {1, -1, 1}}}}}};
  const auto out = run_node(nodes::transform_affine(), mirror, {{Ref<Surface>(s)}}).at(0).as<Surface>();
  ASSERT_NE(out, nullptr);
  EXPECT_EQ(out->points[7], glm::dvec3(1, -3, 0));
  EXPECT_EQ(out->patches[0][1], 4U);
  EXPECT_EQ(out->space, Space::world);
}

TEST(TransformAffine, SharesEveryColumnWithoutSteps) {
  const auto m = mesh();
  const auto out = transformed(m, Json::array());
  EXPECT_EQ(out->at("position").data(), m->at("position").data());
  EXPECT_EQ(out->space(), Space::world);
  const auto moved = transformed(m, {{{"translate", {1, 0, 0}}}});
  EXPECT_EQ(moved->at("triangle").data(), m->at("triangle").data());
}

TEST(TransformAffine, RefusesMapsWithoutAnInverse) {
  const auto code = [](const Json& step) {
    return test::run_error(nodes::transform_affine(), {{"steps", {step}}}, {{mesh()}}).first;
  };
  EXPECT_EQ(code({{"scale", {1, 0, 1}}}), "singular_transform");
  EXPECT_EQ(code({{"rotate", {{"axis", {0, 0, 0}}, {"degrees", 3}}}}), "singular_transform");
  EXPECT_EQ(code({{"quaternion", {0, 0, 0, 0}}}), "singular_transform");
  EXPECT_EQ(code({{"shear", {{"move", "x"}, {"by", "x"}, {"amount", 1}}}}), "singular_transform");
  EXPECT_EQ(code({{"matrix", {{1, 2, 3, 0}, {4, 5, 6, 0}, {7, 8, 9, 0}, {0, 0, 0, 1}}}}),
            "singular_transform");
  EXPECT_EQ(code({{"scale", {1e-20, 1e-20, 1e-20}}}), "");
  EXPECT_THROW(positions({{{"translate", {1, 2, 3}}, {"scale", {1, 1, 1}}}}),
               std::runtime_error);  // two in one step
  EXPECT_THROW(positions({{{"translat", {1, 2, 3}}}}), std::runtime_error);
}

TEST(TransformAffine, ReportsGimbalLockAndLostCondition) {
  Context locked, free, flat;
  transformed(mesh(), {{{"euler", {{"degrees", {10, 90, 20}}}}}}, &locked);
  transformed(mesh(), {{{"euler", {{"degrees", {90, 10, 20}}}}}}, &free);
  transformed(mesh(), {{{"scale", {1, 1, 1e-18}}}}, &flat);
  ASSERT_EQ(locked.warnings().size(), 1U);
  EXPECT_EQ(locked.warnings()[0].first, "gimbal_lock");
  EXPECT_TRUE(free.warnings().empty());
  ASSERT_EQ(flat.warnings().size(), 1U);
  EXPECT_EQ(flat.warnings()[0].first, "ill_conditioned");
}

// Checklist row 10: affine maps keep ratios along lines; computed in double.
TEST(TransformAffine, KeepsRatiosOnLinesInDouble) {
  test::Random random(1);
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 a(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    const glm::dvec3 b(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    points.insert(points.end(), {a, a + (b - a) * 0.25, b});
  }
  Context ctx;
  ctx.precision = Precision::real_double;
  const Json steps = {{{"rotate", {{"axis", {1, 2, 3}}, {"degrees", 37}}}},
                      {{"scale", {3, 0.1, 7}}},
                      {{"translate", {5, 5, 5}}}};
  const auto out = transformed(shared(test::mesh_of(points, {}, Space::world)), steps, &ctx);
  const auto p = test::column<glm::dvec3>(*out, "position");
  for (std::size_t i = 0; i < p.size(); i += 3)
    EXPECT_LE(kernels::norm(p[i] + (p[i + 2] - p[i]) * 0.25 - p[i + 1]), 16 * 0x1p-53 * 20);
}

TEST(TransformAffine, LeavesNaNWhereItIsAndKeepsNormalsWithoutDirection) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Mesh m = test::mesh_of(std::vector<glm::vec3>{{nan, 0, 0}, {1, 1, 1}}, {}, Space::object);
  m.columns.push_back(
      Column::make<glm::vec3>("normal", Domain::vertex, std::vector<glm::vec3>{{0, 0, 0}, {0, 1, 0}}));
  const auto out = transformed(shared(m), {{{"scale", {2, 2, 2}}}});
  EXPECT_EQ(out->at("position").health().nan, 3U);
  EXPECT_EQ(test::column<glm::vec3>(*out, "position")[1], glm::vec3(2));
  EXPECT_EQ(test::column<glm::vec3>(*out, "normal"), (std::vector<glm::vec3>{{0, 0, 0}, {0, 1, 0}}));
  const auto empty = transformed(shared(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::object)),
                                 {{{"scale", {2, 2, 2}}}});
  EXPECT_EQ(empty->vertices(), 0U);
}

}  // namespace
}  // namespace frustum
