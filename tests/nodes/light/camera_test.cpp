// light.camera: everything that casts is in its picture.
#include "nodes/light/camera.h"
#include "nodes/light.h"
#include "runtime/buffers/camera.h"
#include "runtime/buffers/light.h"
#include "tests/support/meshes.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <numbers>

namespace frustum {
namespace {

using glm::dvec3;

Camera camera_at(const Light& light, const std::string& params = R"({"size": 100})", bool empty = false) {
  Mesh ring = test::torus(24, 12);
  if (empty) ring = test::mesh_of<glm::vec3>({}, {}, Space::world);
  return *test::run_geometry(nodes::light_camera(), params,
                             {{"light", {one_light(light)}}, {"mesh", {test::shared(ring)}}})
              .at(0)
              .as<Camera>();
}

// In NDC; all of the mesh for a parallel view.
kernels::Box box_in_ndc(const Camera& c, bool place) {
  const auto view = kernels::look_at(c.eye, c.target, c.up).eye_from_world;
  const auto volume = place ? kernels::perspective(c.fov_y, 1, c.near_z, c.far_z)
                            : kernels::orthographic(c.height, 1, c.near_z, c.far_z);
  kernels::Box box;
  for (const glm::vec3& p : test::column<glm::vec3>(test::torus(24, 12), "position")) {
    const auto clip = kernels::ClipMap<double>(volume)(view.linear * dvec3(p) + view.translation);
    box.add(kernels::divided(clip));
  }
  return box;
}

TEST(LightCamera, HoldsTheMeshTightlyForAnySun) {
  for (const dvec3& d : {dvec3(0, -1, 0), dvec3(0, 1, 0), dvec3(1, 0, 0), dvec3(-0.6, -0.64, 0.48)}) {
    const Camera c = camera_at({.kind = Light::Kind::directional, .direction = d});
    EXPECT_EQ(c.resolution, glm::ivec2(100));
    const kernels::Box box = box_in_ndc(c, false);
    for (glm::length_t k = 0; k < 2; ++k) {
      EXPECT_GE(box.low[k], -0.9801) << d.x << d.y;
      EXPECT_LE(box.high[k], 0.9801);
    }
    EXPECT_GT(std::max(box.high.x - box.low.x, box.high.y - box.low.y), 1.95) << "and wastes no texels";
    EXPECT_GT(box.low.z, -1);
    EXPECT_LT(box.high.z, 1);
  }
}

TEST(LightCamera, HasTheConventionsThatAreAskedFor) {
  const Light light{.kind = Light::Kind::directional, .direction = {0, -1, 0}};
  const Camera c = camera_at(light, R"({"conventions": "vulkan", "subpixel_bits": 4})");
  EXPECT_EQ(c.conventions, Conventions::vulkan);
  EXPECT_EQ(c.subpixel_bits, 4);
  EXPECT_THROW(camera_at(light, R"({"conventions": "d3d", "subpixel_bits": 4})"), NodeError);
}

TEST(LightCamera, OfASpotHoldsItsConeAndWhatIsInIt) {
  const Camera c = camera_at({.kind = Light::Kind::spot,
                              .direction = {0, -1, 0},
                              .position = {0, 4, 0},
                              .inner = 0.2,
                              .outer = 0.5});
  EXPECT_GT(c.fov_y, 1.0);
  EXPECT_LT(c.fov_y, 1.05);
  const kernels::Box box = box_in_ndc(c, true);
  EXPECT_GT(box.low.z, -1);
  EXPECT_LT(box.high.z, 1);
}

TEST(LightCamera, SixSidesOfAPointLightSeeEveryWayOnce) {
  const Light light{.kind = Light::Kind::point, .position = {5, 1, -2}};
  const std::array sides{"+x", "-x", "+y", "-y", "+z", "-z"};
  for (std::size_t i = 0; i < 6; ++i) {
    const Camera c = camera_at(light, std::string(R"({"size": 64, "side": ")") + sides[i] + R"("})");
    dvec3 along(0);
    along[static_cast<glm::length_t>(i / 2)] = i % 2 == 0 ? 1 : -1;
    EXPECT_EQ(c.target - c.eye, along);
    EXPECT_GT(c.fov_y, std::numbers::pi / 2);
    EXPECT_LT(c.fov_y, std::numbers::pi / 2 + 0.04) << "a border of one texel";
  }
}

TEST(LightCamera, NothingToCastStillGivesACamera) {
  const Camera c =
      camera_at({.kind = Light::Kind::directional, .direction = {0, -1, 0}}, R"({"size": 8})", true);
  EXPECT_GT(c.height, 0);
  EXPECT_GT(c.far_z, c.near_z);
}

TEST(LightCamera, RefusesLightsThatAreInNoOnePlace) {
  const auto code = [](const Light& light) {
    try {
      camera_at(light);
    } catch (const NodeError& e) {
      return e.code;
    }
    return std::string("none");
  };
  EXPECT_EQ(code({.kind = Light::Kind::ambient}), "no_source");
  EXPECT_EQ(code({.kind = Light::Kind::area, .edge_u = {1, 0, 0}, .edge_v = {0, 0, 1}}), "area_light");
  EXPECT_EQ(code({.kind = Light::Kind::spot, .inner = 0.1, .outer = 1.5}), "too_wide");
}

}  // namespace
}  // namespace frustum
