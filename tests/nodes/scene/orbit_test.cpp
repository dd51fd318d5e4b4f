#include "nodes/scene/orbit.h"

#include "nodes/kernels/camera.h"
#include "nodes/scene.h"
#include "runtime/buffers/camera.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<Camera> orbit(const Mesh& mesh, const Json& params) {
  return test::run_node(nodes::scene_orbit(), params, {{test::shared(mesh)}}).at(0).as<Camera>();
}

TEST(SceneOrbit, StandsInFrontAtTheStartAndToTheRightAfterAQuarter) {
  const Mesh m = test::torus(16, 8);
  const auto front = orbit(m, {{"start", 0}, {"elevation", 0}, {"frames", 4}});
  EXPECT_EQ(front->eye.x, 0);
  EXPECT_EQ(front->eye.y, 0);
  EXPECT_GT(front->eye.z, 1);
  const auto right = orbit(m, {{"start", 0}, {"elevation", 0}, {"frames", 4}, {"frame", 1}});
  EXPECT_EQ(right->eye.z, 0);
  EXPECT_EQ(right->eye.x, front->eye.z);
}

TEST(SceneOrbit, HasTheConventionsThatAreAskedFor) {
  const Mesh m = test::torus(16, 8);
  const auto c = orbit(m, {{"conventions", "vulkan"}, {"subpixel_bits", 4}, {"reversed_z", true}});
  EXPECT_EQ(c->conventions, Conventions::vulkan);
  EXPECT_EQ(c->subpixel_bits, 4);
  EXPECT_TRUE(c->reversed_z);
  EXPECT_THROW(orbit(m, {{"conventions", "d3d"}, {"subpixel_bits", 4}}), NodeError);
}

TEST(SceneOrbit, RepeatsAfterATurn) {
  const Mesh m = test::torus(16, 8);
  for (const int frame : {-48, 48, 4800000})
    EXPECT_EQ(orbit(m, {{"frame", frame + 5}})->eye, orbit(m, {{"frame", 5}})->eye);
}

// Every vertex is in the view volume, for every frame and shape of picture.
TEST(SceneOrbit, AlwaysHasTheWholeMeshInThePicture) {
  std::vector<glm::vec3> p = {{10, 0, 0}, {14, 1, 2}, {9, 30, -3}};
  const Mesh m = test::mesh_of(p, {{0, 1, 2}}, Space::world);
  for (const auto& [width, height] : {std::pair{640, 360}, std::pair{100, 400}})
    for (int frame = 0; frame < 12; ++frame) {
      const auto c = orbit(m, {{"frame", frame},
                               {"frames", 12},
                               {"margin", 1},
                               {"resolution", {width, height}},
                               {"elevation", 7 * frame - 40}});
      const auto view = kernels::look_at(c->eye, c->target, c->up).eye_from_world;
      const kernels::ClipMap<double> clip(kernels::perspective(c->fov_y, c->aspect(), c->near_z, c->far_z));
      for (const glm::vec3& q : p) {
        const glm::dvec4 h = clip(kernels::PointMap<double>(view)(glm::dvec3(q)));
        for (glm::length_t k = 0; k < 3; ++k)
          EXPECT_LE(std::fabs(h[k]), h.w * (1 + 1e-12)) << frame << " " << k;
      }
    }
}

TEST(SceneOrbit, LooksAtAPointFromADistanceAndAtNothingNotAtAll) {
  const auto c =
      orbit(test::mesh_of(std::vector<glm::vec3>(3, {1, 2, 3}), {{0, 1, 2}}, Space::object), Json::object());
  EXPECT_EQ(c->target, glm::dvec3(1, 2, 3));
  EXPECT_GT(c->near_z, 0);
  EXPECT_EQ(test::run_error(nodes::scene_orbit(), Json::object(),
                            {{test::shared(test::mesh_of(std::vector<glm::vec3>{}, {}, Space::object))}})
                .first,
            "no_bounds");
}

}  // namespace
}  // namespace frustum
