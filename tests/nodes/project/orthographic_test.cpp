#include "nodes/project/orthographic.h"

#include "nodes/project.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <limits>

namespace frustum {
namespace {

Camera camera() {
  Camera c;
  c.height = 4, c.near_z = 1, c.far_z = 5, c.resolution = {200, 100};
  return c;
}

std::vector<glm::vec4> clip(const std::vector<glm::vec3>& points, const Camera& c) {
  const auto m = test::shared(test::mesh_of(points, {}, Space::eye));
  const auto out = test::run_node(nodes::project_orthographic(), Json::object(),
                                  {{m}, {std::make_shared<const Camera>(c)}})
                       .at(0)
                       .as<Mesh>();
  EXPECT_EQ(out->space(), Space::clip);
  return test::column<glm::vec4>(*out, "position");
}

TEST(ProjectOrthographic, MapsTheBoxToTheCube) {
  EXPECT_EQ(clip({{4, 2, -1}, {-4, -2, -5}, {0, 1, -3}}, camera()),
            (std::vector<glm::vec4>{{1, 1, -1, 1}, {-1, -1, 1, 1}, {0, 0.5F, 0, 1}}));
  Camera reversed = camera();
  reversed.reversed_z = true;
  EXPECT_EQ(clip({{4, 2, -1}, {-4, -2, -5}}, reversed),
            (std::vector<glm::vec4>{{1, 1, 1, 1}, {-1, -1, 0, 1}}));
}

// Row 18: moving away changes depth alone.
TEST(ProjectOrthographic, KeepsSizesAtEveryDistance) {
  const auto p = clip({{1, 1, -1}, {1, 1, -2}, {1, 1, -4.5F}}, camera());
  for (std::size_t i = 1; i < p.size(); ++i) {
    EXPECT_EQ(p[i].x, p[0].x);
    EXPECT_EQ(p[i].y, p[0].y);
    EXPECT_GT(p[i].z, p[i - 1].z);
    EXPECT_EQ(p[i].w, 1);
  }
  EXPECT_TRUE(clip({}, camera()).empty());
}

TEST(ProjectOrthographic, RefusesImpossibleVolumes) {
  const auto code = [](auto change) {
    Camera c = camera();
    change(c);
    const auto m = test::shared(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::eye));
    return test::run_error(nodes::project_orthographic(), Json::object(),
                           {{m}, {std::make_shared<const Camera>(c)}})
        .first;
  };
  EXPECT_EQ(code([](Camera&) {}), "");
  EXPECT_EQ(code([](Camera& c) { c.height = 0; }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.far_z = std::numeric_limits<double>::infinity(); }), "impossible_camera");
  EXPECT_EQ(code([](Camera& c) { c.far_z = 0.5; }), "impossible_camera");
}

}  // namespace
}  // namespace frustum
