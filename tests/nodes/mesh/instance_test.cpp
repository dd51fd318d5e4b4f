#include "nodes/mesh/instance.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

Ref<Mesh> copies(const Ref<Mesh>& mesh, const Json& placements, const Ref<Mesh>& points = nullptr,
                 Context* ctx = nullptr) {
  return test::run_node(nodes::mesh_instance(), {{"placements", placements}},
                        {{mesh}, points ? std::vector<Buffer>{points} : std::vector<Buffer>{}, {}}, ctx)
      .at(0)
      .as<Mesh>();
}

TEST(MeshInstance, MovesByAddingAndRoundingOnce) {
  const auto m = test::shared(test::mesh_of(std::vector<glm::vec3>{{0.1F, 1e-8F, 3}, {1, 0, 0}, {0, 1, 0}},
                                            {{0, 1, 2}}, Space::object));
  const auto out = copies(m, {{{"translate", {0, 0, 0}}}, {{"translate", {1.1, 0, -2}}}});
  const auto p = test::column<glm::vec3>(*out, "position");
  EXPECT_EQ(p[0], glm::vec3(0.1F, 1e-8F, 3));
  EXPECT_EQ(p[3], glm::vec3(static_cast<float>(static_cast<double>(0.1F) + 1.1), 1e-8F, 1));
  EXPECT_EQ(test::column<glm::uvec3>(*out, "triangle")[1], glm::uvec3(3, 4, 5));
  EXPECT_EQ(test::column<std::uint32_t>(*out, "instance"), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(out->space(), Space::world);
}

// Stretched, turned and mirrored copies of a closed ring keep their fronts outside and their normals along.
TEST(MeshInstance, KeepsFrontsAndNormalsUnderEveryPlacement) {
  const auto ring = test::run_node(nodes::mesh_torus(), {{"segments", 12}, {"sides", 8}}).at(0).as<Mesh>();
  const Json placements = {{{"scale", {1, 3, 0.5}}},
                           {{"scale", {-1, 1, 1}}, {"translate", {5, 0, 0}}},
                           {{"scale", {-2, -2, -2}}, {"axis", {1, 2, 3}}, {"degrees", 77}}};
  const auto out = copies(ring, placements);
  EXPECT_EQ(out->validate(), "");
  EXPECT_EQ(out->closed, true);
  EXPECT_EQ(test::statistic(out, "closed"), 1);
  EXPECT_EQ(test::statistic(out, "components"), 3);
  const double volume = test::statistic(ring, "volume");
  EXPECT_NEAR(test::statistic(out, "volume"), volume * (1.5 + 1 + 8), 1e-5);
  for (std::size_t f = 0; f < out->faces(); ++f)
    for (std::size_t c = 0; c < 3; ++c) {
      const glm::dvec3 n = test::normal_at(*out, f, c), across = test::area_vector(*out, f);
      ASSERT_GT(n.x * across.x + n.y * across.y + n.z * across.z, 0) << f;
      ASSERT_NEAR(n.x * n.x + n.y * n.y + n.z * n.z, 1, 4e-7);
    }
}

// The uv of a mirrored face stays at its vertex.
TEST(MeshInstance, CarriesCornersOfMirroredFacesAlong) {
  const std::vector<glm::vec2> uv = {{0, 0}, {1, 0}, {0, 1}};
  const auto m = test::shared(
      test::mesh_of(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, Space::object)
          .with(Column::make<glm::vec2>("uv", Domain::corner, uv)));
  const auto out = copies(m, {{{"scale", {-1, 1, 1}}}});
  EXPECT_EQ(test::column<glm::uvec3>(*out, "triangle")[0], glm::uvec3(0, 2, 1));
  EXPECT_EQ(test::column<glm::vec2>(*out, "uv"), (std::vector<glm::vec2>{{0, 0}, {0, 1}, {1, 0}}));
}

TEST(MeshInstance, PutsACopyAtEveryPoint) {
  Context ctx;
  const auto points = test::shared(
      test::mesh_of(std::vector<glm::vec3>{{10, 0, 0}, {NAN, 0, 0}, {20, 0, 0}}, {}, Space::object));
  const auto m = test::shared(
      test::mesh_of(std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, Space::object));
  const auto out = copies(m, {{{"translate", {1, 0, 0}}}, {{"translate", {2, 0, 0}}}}, points, &ctx);
  const auto p = test::column<glm::vec3>(*out, "position");
  ASSERT_EQ(p.size(), 12U);
  EXPECT_EQ(p[0].x, 11);
  EXPECT_EQ(p[3].x, 12);
  EXPECT_EQ(p[6].x, 21);
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "points_not_finite");
}

TEST(MeshInstance, TakesMatricesBeforePlacements) {
  const auto m = test::shared(test::mesh_of(std::vector<glm::vec3>{{1, 0, 0}}, {}, Space::object));
  glm::dmat4 twice(2.0);
  twice[3][3] = 1;
  const auto matrix = std::make_shared<const Matrix>(Matrix{twice});
  const auto out =
      test::run_node(nodes::mesh_instance(), {{"placements", {Json::object()}}}, {{m}, {}, {matrix}})
          .at(0)
          .as<Mesh>();
  EXPECT_EQ(test::column<glm::vec3>(*out, "position"), (std::vector<glm::vec3>{{2, 0, 0}, {1, 0, 0}}));
}

TEST(MeshInstance, RefusesWhatHasNoInverseAndWhatCannotBeCounted) {
  const auto m = test::shared(test::torus(64, 64, Space::object));
  const auto error = [&](const Json& placements, const Ref<Mesh>& points) {
    return test::run_error(nodes::mesh_instance(), {{"placements", placements}},
                           {{m}, points ? std::vector<Buffer>{points} : std::vector<Buffer>{}, {}})
        .first;
  };
  EXPECT_EQ(error({{{"scale", {1, 0, 1}}}}, nullptr), "singular_transform");
  EXPECT_EQ(error({{{"axis", {0, 0, 0}}, {"degrees", 30}}}, nullptr), "singular_transform");
  EXPECT_EQ(error(Json::array(), test::shared(test::torus(1024, 512, Space::object))), "too_large");
}

TEST(MeshInstance, KeepsSourcesApart) {
  const Mesh m =
      test::mesh_of(std::vector<glm::vec3>(3), {{0, 1, 2}, {0, 1, 2}}, Space::object)
          .with(Column::make<std::uint32_t>("origin", Domain::face, std::vector<std::uint32_t>{4, 2}));
  const auto out = copies(test::shared(m), {Json::object(), Json::object()});
  EXPECT_EQ(test::column<std::uint32_t>(*out, "origin"), (std::vector<std::uint32_t>{4, 2, 9, 7}));
}

}  // namespace
}  // namespace frustum
