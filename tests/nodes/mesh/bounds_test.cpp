#include "nodes/mesh/bounds.h"

#include "tests/support/mesh_checks.h"
#include "tests/support/meshes.h"

namespace frustum {
namespace {

std::vector<Buffer> bounds(const Mesh& mesh) {
  return test::run_node(nodes::mesh_bounds(), Json::object(), {{test::shared(mesh)}});
}

glm::dvec3 row(const Table& t, std::size_t i) {
  return {t.columns[1].numbers[i], t.columns[2].numbers[i], t.columns[3].numbers[i]};
}

TEST(MeshBounds, MeasureWhatFacesUse) {
  const auto out = bounds(test::mesh_of(
      std::vector<glm::vec3>{{1, 0, 0}, {4, 0, 0}, {1, 4, 0}, {100, 100, 100}}, {{0, 1, 2}}, Space::object));
  const auto t = out[0].as<Table>();
  EXPECT_EQ(t->columns[0].texts, (std::vector<std::string>{"min", "max", "size", "centre", "centroid"}));
  EXPECT_EQ(row(*t, 0), glm::dvec3(1, 0, 0));
  EXPECT_EQ(row(*t, 1), glm::dvec3(4, 4, 0));
  EXPECT_EQ(row(*t, 2), glm::dvec3(3, 4, 0));
  EXPECT_EQ(row(*t, 3), glm::dvec3(2.5, 2, 0));
  EXPECT_NEAR(row(*t, 4).x, 2, 1e-15);
  EXPECT_NEAR(row(*t, 4).y, 4.0 / 3, 1e-15);
  EXPECT_EQ(out[1].as<Number>()->value, 5);
}

TEST(MeshBounds, FitTheLongestSideIntoTheUnitCube) {
  const auto out = bounds(
      test::mesh_of(std::vector<glm::vec3>{{1, 0, 0}, {3, 0, 0}, {1, 8, 0}}, {{0, 1, 2}}, Space::object));
  const glm::dmat4 fit = out[2].as<Matrix>()->value;
  EXPECT_EQ(fit * glm::dvec4(1, 0, 0, 1), glm::dvec4(-0.25, -1, 0, 1));
  EXPECT_EQ(fit * glm::dvec4(3, 8, 0, 1), glm::dvec4(0.25, 1, 0, 1));
}

TEST(MeshBounds, MoveAPointAndDoNotScaleIt) {
  const auto out = bounds(test::mesh_of(std::vector<glm::vec3>(3, {2, 3, 4}), {{0, 1, 2}}, Space::object));
  EXPECT_EQ(out[2].as<Matrix>()->value * glm::dvec4(2, 3, 4, 1), glm::dvec4(0, 0, 0, 1));
  EXPECT_EQ(row(*out[0].as<Table>(), 4), glm::dvec3(2, 3, 4));
}

TEST(MeshBounds, HoldForHugeMeshesAndLeaveOutWhatIsNotFinite) {
  const auto out = bounds(test::mesh_of(std::vector<glm::vec3>{{-3e38F, 0, 0}, {3e38F, 0, 0}, {0, NAN, 0}},
                                        {{0, 1, 2}}, Space::object));
  EXPECT_EQ(out[0].health().nan, 0U);
  EXPECT_NEAR(out[1].as<Number>()->value / 6e38, 1, 1e-6);
}

TEST(MeshBounds, NeedAFace) {
  EXPECT_EQ(test::run_error(nodes::mesh_bounds(), Json::object(),
                            {{test::shared(test::mesh_of(std::vector<glm::vec3>(3), {}, Space::object))}})
                .first,
            "no_bounds");
}

}  // namespace
}  // namespace frustum
