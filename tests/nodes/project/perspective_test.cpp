#include "nodes/project/perspective.h"

#include "nodes/project.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace frustum {
namespace {

Camera camera() {
  Camera c;
  c.fov_y = 2 * kernels::atan(1.0);  // 90 degrees
  c.near_z = 1, c.far_z = 3, c.resolution = {200, 100};
  return c;
}

Ref<Mesh> clip(const std::vector<glm::vec3>& points, const Camera& c) {
  const auto m = test::shared(test::mesh_of(points, {}, Space::eye));
  return test::run_node(nodes::project_perspective(), Json::object(),
                        {{m}, {std::make_shared<const Camera>(c)}})
      .at(0)
      .as<Mesh>();
}

TEST(ProjectPerspective, MapsCornersOfTheVolumeByHand) {
  const auto out = clip({{2, 1, -1}, {-6, -3, -3}, {0, 0, -1.5F}}, camera());
  const auto p = test::column<glm::vec4>(*out, "position");
  EXPECT_LE(kernels::norm(p[0] - glm::vec4(1, 1, -1, 1)), 4e-7F);
  EXPECT_LE(kernels::norm(p[1] - glm::vec4(-3, -3, 3, 3)), 1e-6F);
  EXPECT_EQ(p[2], glm::vec4(0, 0, 0, 1.5F));  // z = -2 (-1.5) - 3
  EXPECT_EQ(out->space(), Space::clip);
  EXPECT_EQ(out->camera->resolution, glm::ivec2(200, 100));
}

// Row 20: depth rises with distance, or falls when reversed; lines stay lines.
TEST(ProjectPerspective, OrdersDepthEitherWay) {
  for (const bool reversed : {false, true}) {
    Camera c = camera();
    c.reversed_z = reversed;
    c.far_z = reversed ? std::numeric_limits<double>::infinity() : 1000;
    std::vector<glm::vec3> line;
    for (int i = 0; i < 200; ++i)
      line.emplace_back(0.1F * static_cast<float>(i), 1, -1 - 0.5F * static_cast<float>(i));
    const auto p = test::column<glm::vec4>(*clip(line, c), "position");
    for (std::size_t i = 1; i < p.size(); ++i) {
      const auto a = kernels::divided(glm::dvec4(p[i - 1])), b = kernels::divided(glm::dvec4(p[i]));
      EXPECT_TRUE(reversed ? a.z > b.z : a.z < b.z);
      const auto first = kernels::divided(glm::dvec4(p[0])), last = kernels::divided(glm::dvec4(p.back()));
      const double off = (b.x - first.x) * (last.y - first.y) - (b.y - first.y) * (last.x - first.x);
      EXPECT_NEAR(off, 0, 8 * 0x1p-24);
    }
  }
}

TEST(ProjectPerspective, DividesNothing) {
  const auto p = test::column<glm::vec4>(*clip({{1, 1, 0}, {1, 1, 5}}, camera()), "position");
  EXPECT_EQ(p[0].w, 0);
  EXPECT_EQ(p[1].w, -5);
  EXPECT_TRUE(std::isfinite(p[0].x) && std::isfinite(p[1].z));
  EXPECT_EQ(clip({}, camera())->vertices(), 0U);
}

TEST(ProjectPerspective, RefusesImpossibleVolumes) {
  const auto code = [](auto change) {
    Camera c = camera();
    change(c);
    const auto m = test::shared(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::eye));
    return test::run_error(nodes::project_perspective(), Json::object(),
                           {{m}, {std::make_shared<const Camera>(c)}})
        .first;
  };
  EXPECT_EQ(code([](Camera&) {}), "");
  EXPECT_EQ(code([](Camera& c) { c.near_z = 0; }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.far_z = 1; }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.fov_y = 0; }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.fov_y = 3.2; }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.resolution = {10, 0}; }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.near_z = std::nan(""); }), "impossible_camera");
}

// A far ball shone through a near one, in silence, where all depths had become one number.
TEST(ProjectPerspective, ANearPlaneTooNearIsSaid) {
  const auto warnings = [](double near, bool reversed, const std::vector<glm::vec3>& points,
                           Precision precision = Precision::single) {
    Camera c = camera();
    c.near_z = near, c.far_z = 1000, c.reversed_z = reversed;
    Context ctx;
    ctx.precision = precision;
    test::run_node(
        nodes::project_perspective(), Json::object(),
        {{test::shared(test::mesh_of(points, {}, Space::eye))}, {std::make_shared<const Camera>(c)}}, &ctx);
    return ctx.warnings();
  };
  const std::vector<glm::vec3> two{{0, 0, -4}, {0, 0, -9}};
  for (const bool reversed : {false, true}) {
    EXPECT_TRUE(warnings(0.1, reversed, two).empty());
    EXPECT_TRUE(warnings(1e-60, reversed, {{0, 0, -4}, {1, 2, -4}}).empty()) << "equally far";
    EXPECT_TRUE(warnings(1e-60, reversed, {{0, 0, 4}, {0, 0, 9}}).empty()) << "behind the eye";
    const auto w = warnings(1e-60, reversed, two);
    ASSERT_EQ(w.size(), 1u) << reversed;
    EXPECT_EQ(w[0].first, "one_depth");
    EXPECT_NE(w[0].second.find("vertices 4 and 9 away have the same depth in single"), std::string::npos)
        << w[0].second;
  }
  EXPECT_EQ(warnings(1e-300, false, two, Precision::real_double).size(), 1u);
  EXPECT_TRUE(warnings(1e-12, false, two, Precision::real_double).empty());
  EXPECT_EQ(warnings(1e-12, false, two).size(), 1u);
}

}  // namespace
}  // namespace frustum
