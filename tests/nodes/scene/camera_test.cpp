#include "nodes/scene/camera.h"

#include "nodes/scene.h"
#include "runtime/buffers/camera.h"
#include "tests/support/run_node.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace frustum {
namespace {

Camera camera(const Json& params) {
  return *test::run_node(nodes::scene_camera(), params).at(0).as<Camera>();
}
std::string error(const Json& params) { return test::run_error(nodes::scene_camera(), params).first; }

TEST(SceneCamera, ConvertsDegreesAndKeepsTheRest) {
  const Camera c =
      camera({{"eye", {4, 3, 6}}, {"target", {0, 1, 0}}, {"fov_y", 90}, {"resolution", {640, 480}}});
  EXPECT_EQ(c.eye, glm::dvec3(4, 3, 6));
  EXPECT_EQ(c.target, glm::dvec3(0, 1, 0));
  EXPECT_DOUBLE_EQ(c.fov_y, 1.5707963267948966);
  EXPECT_EQ(c.resolution, glm::ivec2(640, 480));
  EXPECT_DOUBLE_EQ(c.aspect(), 4.0 / 3);
  EXPECT_FALSE(c.reversed_z);
}

TEST(SceneCamera, HasTheDefaultsOfItsBuffer) {
  const Camera c = camera(Json::object()), d;
  EXPECT_EQ(c.eye, d.eye);
  EXPECT_EQ(c.up, d.up);
  EXPECT_EQ(c.fov_y, d.fov_y);
  EXPECT_EQ(c.near_z, d.near_z);
  EXPECT_EQ(c.far_z, d.far_z);
  EXPECT_EQ(c.resolution, d.resolution);
  EXPECT_EQ(c.conventions, d.conventions);
  EXPECT_EQ(c.subpixel_bits, d.subpixel_bits);
}

TEST(SceneCamera, HasTheConventionsOfAnApi) {
  using kernels::DepthRange;
  const auto space = [](const Json& params) {
    const Camera c = camera(params);
    return clip_space(&c);
  };
  EXPECT_EQ(space(Json::object()).depth, DepthRange::minus_one_to_one);
  EXPECT_EQ(space({{"conventions", "vulkan"}}).depth, DepthRange::zero_to_one);
  EXPECT_EQ(space({{"conventions", "d3d"}}).depth, DepthRange::zero_to_one);
  for (const char* api : {"gl", "vulkan", "d3d"}) {
    EXPECT_EQ(space({{"conventions", api}, {"reversed_z", true}}).depth, DepthRange::one_to_zero);
    EXPECT_EQ(space({{"conventions", api}}).y_down, std::string_view(api) == "vulkan");
  }
  EXPECT_EQ(clip_space(nullptr).depth, DepthRange::minus_one_to_one);
  EXPECT_FALSE(clip_space(nullptr).y_down);
  EXPECT_EQ(provoking_corner(Conventions::gl), 2);
  EXPECT_EQ(provoking_corner(Conventions::vulkan), 0);
  EXPECT_EQ(provoking_corner(Conventions::d3d), 0);
}

// What a camera's conventions change is seen by the cache and in summaries.
TEST(SceneCamera, IsAnotherBufferWithOtherConventions) {
  const auto buffer = [](const Json& params) { return test::run_node(nodes::scene_camera(), params).at(0); };
  const Buffer usual = buffer(Json::object()), vulkan = buffer({{"conventions", "vulkan"}}),
               coarse = buffer({{"subpixel_bits", 4}});
  EXPECT_NE(usual.digest(), vulkan.digest());
  EXPECT_NE(usual.digest(), coarse.digest());
  EXPECT_EQ(vulkan.type().summary(vulkan.data())["conventions"], "vulkan");
  EXPECT_EQ(coarse.type().summary(coarse.data())["subpixel_bits"], 4);
}

// Direct3D 11.3 asks for 16.8 fixed point; the others for 4 bits or more.
TEST(SceneCamera, LetsDirect3DSnapToEightBitsOnly) {
  EXPECT_EQ(error({{"conventions", "d3d"}, {"subpixel_bits", 8}}), "");
  EXPECT_EQ(error({{"conventions", "d3d"}, {"subpixel_bits", 4}}), "impossible_camera");
  EXPECT_EQ(error({{"conventions", "vulkan"}, {"subpixel_bits", 4}}), "");
  EXPECT_THROW(camera({{"subpixel_bits", 3}}), std::runtime_error);
  EXPECT_THROW(camera({{"subpixel_bits", 9}}), std::runtime_error);
}

TEST(SceneCamera, PutsTheFarPlaneAtInfinityForNull) {
  EXPECT_EQ(camera({{"far", nullptr}}).far_z, std::numeric_limits<double>::infinity());
}

TEST(SceneCamera, RefusesImpossibleNumbers) {
  EXPECT_EQ(error({{"near", 2}, {"far", 1}}), "impossible_camera");
  EXPECT_EQ(error({{"near", 2}, {"far", 2}}), "impossible_camera");
  EXPECT_THROW(camera({{"near", 0}}), std::runtime_error);
  EXPECT_THROW(camera({{"fov_y", 180}}), std::runtime_error);
  EXPECT_THROW(camera({{"resolution", {0, 10}}}), std::runtime_error);
  EXPECT_THROW(camera({{"fovy", 30}}), std::runtime_error);
  const glm::dvec3 eye(0, 0, 5), target(0), up(0, 1, 0);
  EXPECT_FALSE(scene::fault_of_camera({std::nan(""), 0, 0}, target, up, 1, 2).empty());
  EXPECT_FALSE(scene::fault_of_camera(eye, eye, up, 1, 2).empty());
  EXPECT_FALSE(scene::fault_of_camera(eye, target, {}, 1, 2).empty());
  EXPECT_TRUE(scene::fault_of_camera(eye, target, up, 1, 2).empty());
}

}  // namespace
}  // namespace frustum
