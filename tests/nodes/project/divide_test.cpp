#include "nodes/project/divide.h"

#include "nodes/project.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<Mesh> ndc(const Mesh& m, Context* ctx = nullptr) {
  return test::run_node(nodes::project_divide(), Json::object(), {{test::shared(m)}}, ctx).at(0).as<Mesh>();
}

TEST(ProjectDivide, DividesByW) {
  const auto out = ndc(test::mesh_of(std::vector<glm::vec4>{{1, 2, 3, 4}, {-2, 0, 2, 2}}, {}, Space::clip));
  EXPECT_EQ(test::column<glm::vec3>(*out, "position"),
            (std::vector<glm::vec3>{{0.25F, 0.5F, 0.75F}, {-1, 0, 1}}));
  EXPECT_EQ(out->space(), Space::ndc);
}

// PRJ-02: x / w, not x (1 / w).
TEST(ProjectDivide, HoldsForTinyW) {
  const auto out = ndc(test::mesh_of(std::vector<glm::vec4>{{1e-39F, -1e-39F, 0, 1e-39F}}, {}, Space::clip));
  EXPECT_EQ(test::column<glm::vec3>(*out, "position")[0], glm::vec3(1, -1, 0));
}

// PRJ-01, PRJ-03: what has no point loses its faces, with a warning; no infinity leaves.
TEST(ProjectDivide, DropsFacesOnOrBehindTheEyesPlane) {
  const std::vector<glm::vec4> p = {{0, 0, 0, 1}, {1, 0, 0, 1},     {0, 1, 0, 1},
                                    {1, 1, 0, 0}, {1, 1, 0, -0.5F}, {NAN, 0, 0, 1}};
  Context ctx;
  const auto out =
      ndc(test::mesh_of(p, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 1, 5}, {2, 1, 0}}, Space::clip), &ctx);
  EXPECT_EQ(test::column<std::uint32_t>(*out, "origin"), (std::vector<std::uint32_t>{0, 4}));
  EXPECT_TRUE(out->at("position").health().finite());
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "faces_behind_the_eye");
  Context quiet;
  ndc(test::mesh_of(p, {{0, 1, 2}}, Space::clip), &quiet);  // points that no face uses are no one's loss
  EXPECT_TRUE(quiet.warnings().empty());
  EXPECT_EQ(ndc(test::mesh_of(std::vector<glm::vec4>{}, {}, Space::clip))->faces(), 0U);
}

}  // namespace
}  // namespace frustum
