#include "nodes/light.h"
#include "nodes/shade.h"
#include "runtime/buffers/light.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <numbers>

namespace frustum {
namespace {

Ref<LightSet> spot(const std::string& params) {
  return test::run_geometry(nodes::light_spot(), params, {}).at(0).as<LightSet>();
}

TEST(LightSpot, HoldsAUnitAxisAndAnglesInRadians) {
  const Light light =
      spot(R"({"position": [1, 2, 3], "direction": [0, -5, 0], "inner": 30, "outer": 90})")->lights.at(0);
  EXPECT_EQ(light.kind, Light::Kind::spot);
  EXPECT_EQ(light.position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(light.direction, glm::dvec3(0, -1, 0));
  EXPECT_DOUBLE_EQ(light.inner, std::numbers::pi / 6);
  EXPECT_DOUBLE_EQ(light.outer, std::numbers::pi / 2);
}

TEST(LightSpot, WhatIsNoConeIsRefused) {
  const auto code = [](const std::string& params) {
    try {
      spot(params);
    } catch (const NodeError& e) {
      return e.code + " " + e.part;
    }
    return std::string("none");
  };
  EXPECT_EQ(code(R"({"inner": 31, "outer": 30})"), "bad_cone /params/inner");
  EXPECT_EQ(code(R"({"direction": [0, 0, 0]})"), "zero_direction /params/direction");
  EXPECT_EQ(code(R"({"attenuation": [0, 0, 0]})"), "bad_attenuation /params/attenuation");
  EXPECT_EQ(code(R"({"inner": 30, "outer": 30})"), "none") << "a hard edge";
}

}  // namespace
}  // namespace frustum
