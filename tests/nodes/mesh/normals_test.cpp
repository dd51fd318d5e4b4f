#include "nodes/mesh/normals.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

#include <cmath>

namespace frustum {
namespace {

Ref<Mesh> normals(const Mesh& mesh, const Json& params, Context* ctx = nullptr) {
  return test::run_node(nodes::mesh_normals(), params, {{test::shared(mesh)}}, ctx).at(0).as<Mesh>();
}

// A corner of a cube: three quads, one of them cut the other way, around vertex 0.
Mesh cube_corner() {
  return test::mesh_of(
      std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}},
      {{0, 4, 1}, {0, 2, 4}, {0, 3, 5}, {0, 5, 2}, {0, 1, 3}, {1, 6, 3}}, Space::object);
}

void expect_near(const glm::dvec3& got, const glm::dvec3& want, double bound = 1e-6) {
  for (glm::length_t k = 0; k < 3; ++k) EXPECT_NEAR(got[k], want[k], bound);
}

// Two faces lie on one side of the corner, two on the next, one on the third: by angle the sides count alike.
TEST(MeshNormals, DoNotDependOnTheDiagonalsWhenWeightedByAngle) {
  const auto by_angle = normals(cube_corner(), {{"crease", 180}, {"weight", "angle"}});
  EXPECT_EQ(by_angle->at("normal").domain(), Domain::vertex);
  const double third = -std::sqrt(1.0 / 3);
  expect_near(test::normal_at(*by_angle, 0, 0), {third, third, third});
  const auto uniform = normals(cube_corner(), {{"crease", 180}, {"weight", "uniform"}});
  expect_near(test::normal_at(*uniform, 0, 0), glm::dvec3(-2, -1, -2) / 3.0);
}

TEST(MeshNormals, AreWeightedByArea) {
  // A large face up, a small one towards +x.
  const Mesh m = test::mesh_of(std::vector<glm::vec3>{{0, 0, 0}, {0, 0, 4}, {-4, 0, 0}, {0, -1, 0}},
                               {{0, 2, 1}, {0, 1, 3}}, Space::object);
  const auto out = normals(m, {{"crease", 180}, {"weight", "area"}});
  const glm::dvec3 n = test::normal_at(*out, 0, 0);
  EXPECT_NEAR(std::fabs(n.y / n.x), 4, 1e-5);  // areas 8 and 2
}

TEST(MeshNormals, AreSharpAtCreasesAndSmoothElsewhere) {
  const auto box = test::run_node(nodes::mesh_box(), Json::object()).at(0).as<Mesh>();
  const auto sharp = normals(*box, {{"crease", 60}});
  EXPECT_EQ(test::column<glm::vec3>(*sharp, "normal"), test::column<glm::vec3>(*box, "normal"));
  const auto round = normals(*box, {{"crease", 91}});
  for (std::size_t f = 0; f < 12; ++f)
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec3 p = test::position_at(*round, round->triangles()[f][static_cast<glm::length_t>(c)]);
      expect_near(test::normal_at(*round, f, c), p / std::sqrt(3.0));
    }
}

TEST(MeshNormals, ComeNearTheSphereAsTrianglesGetSmaller) {
  double before = 1;
  for (const int rings : {8, 16, 32}) {
    const auto ball =
        test::run_node(nodes::mesh_sphere(), {{"segments", 2 * rings}, {"rings", rings}}).at(0).as<Mesh>();
    const auto out = normals(*ball, {{"crease", 179}});
    double worst = 0;
    for (std::size_t f = 0; f < out->faces(); ++f)
      for (std::size_t c = 0; c < 3; ++c) {
        const glm::dvec3 d = test::normal_at(*out, f, c) -
                             test::position_at(*out, out->triangles()[f][static_cast<glm::length_t>(c)]);
        worst = std::max(worst, kernels::norm(d));
      }
    EXPECT_LT(worst, before / 3);  // second order: a quarter each time
    before = worst;
  }
  EXPECT_LT(before, 0.003);
}

// The seam of a texture splits vertices; normals go across it, unless told not to.
TEST(MeshNormals, GoAcrossSeamsWhereVerticesAreJoined) {
  const std::vector<glm::vec3> p = {{-1, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 1, 0}, {1, 0, 0}, {0, 1, 1}};
  const Mesh roof = test::mesh_of(p, {{0, 2, 1}, {3, 5, 4}}, Space::object);
  expect_near(test::normal_at(*normals(roof, {{"crease", 120}}), 0, 1), {0, 1, 0});
  const double half = std::sqrt(0.5);
  expect_near(test::normal_at(*normals(roof, {{"crease", 120}, {"join", false}}), 0, 1), {-half, half, 0});
}

// An edge that two faces run the same way, or that three share, is sharp whatever the crease.
TEST(MeshNormals, StaySharpWhereSidesCannotBeTold) {
  const std::vector<glm::vec3> p = {{-1, 0, 0}, {0, 0, 0}, {0, 0, 1}, {1, 0.1F, 0}};
  const Mesh turned = test::mesh_of(p, {{0, 2, 1}, {1, 3, 2}}, Space::object);
  const auto out = normals(turned, {{"crease", 179}});
  EXPECT_LT(test::normal_at(*out, 0, 1).y * test::normal_at(*out, 1, 0).y, 0);
  EXPECT_NEAR(std::fabs(test::normal_at(*out, 0, 1).y), 1, 1e-6);
}

TEST(MeshNormals, GiveFacesWithoutAreaTheirNeighboursNormal) {
  Context ctx;
  const std::vector<glm::vec3> p = {{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {2, 0, 0}, {5, 5, 5}, {NAN, 0, 0}};
  const Mesh m = test::mesh_of(p, {{0, 1, 2}, {0, 1, 3}, {4, 4, 4}, {4, 5, 4}}, Space::object);
  const auto out = normals(m, Json::object(), &ctx);
  expect_near(test::normal_at(*out, 1, 0), {0, 1, 0});
  expect_near(test::normal_at(*out, 2, 0), {0, 0, 1});
  EXPECT_EQ(out->at("normal").health().nan, 0U);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "normals_without_direction");
}

TEST(MeshNormals, HoldForTinyAndHugeMeshes) {
  for (const float size : {1e-30F, 1e30F}) {
    const Mesh m = test::mesh_of(std::vector<glm::vec3>{{0, 0, 0}, {size, 0, 0}, {0, 0, -size}}, {{0, 1, 2}},
                                 Space::object);
    for (const char* weight : {"angle", "area", "uniform"})
      EXPECT_EQ(test::normal_at(*normals(m, {{"weight", weight}}), 0, 0), glm::dvec3(0, 1, 0));
  }
}

// A fan of 100000 faces around one vertex: quadratic time would take minutes.
TEST(MeshNormals, AreLinearAtAHub) {
  std::vector<glm::vec3> p = {{0, 0, 0}};
  std::vector<glm::uvec3> t;
  constexpr std::uint32_t n = 100000;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 6.283185307179586 * i / n;
    p.emplace_back(std::cos(a), 0, -std::sin(a));
    t.emplace_back(0, 1 + i, 1 + (i + 1) % n);
  }
  expect_near(test::normal_at(*normals(test::mesh_of(p, t, Space::object), Json::object()), 0, 0), {0, 1, 0});
}

}  // namespace
}  // namespace frustum
