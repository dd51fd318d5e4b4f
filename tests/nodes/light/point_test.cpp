#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

TEST(LightPoint, HoldsPlaceAndAttenuation) {
  const auto light =
      test::run_geometry(nodes::light_point(), R"({"position": [1, 2, 3], "attenuation": [0, 0, 2]})", {})
          .at(0)
          .as<LightSet>()
          ->lights.at(0);
  EXPECT_EQ(light.kind, Light::Kind::point);
  EXPECT_EQ(light.position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(light.attenuation, glm::dvec3(0, 0, 2));
}

TEST(LightPoint, AnAttenuationOfZeroWouldDivideByZero) {
  try {
    test::run_geometry(nodes::light_point(), R"({"attenuation": [0, 0, 0]})", {});
    FAIL() << "no error";
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "bad_attenuation");
  }
}

}  // namespace
}  // namespace frustum
