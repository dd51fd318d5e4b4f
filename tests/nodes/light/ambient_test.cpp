#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

TEST(LightAmbient, HoldsItsColour) {
  const auto light = test::run_geometry(nodes::light_ambient(), R"({"color": [0.08, 0.09, 0.12]})", {})
                         .at(0)
                         .as<LightSet>()
                         ->lights.at(0);
  EXPECT_EQ(light.kind, Light::Kind::ambient);
  EXPECT_EQ(light.color, glm::dvec3(0.08, 0.09, 0.12));
}

TEST(LightAmbient, NeverDarkens) {
  EXPECT_THROW(test::params_of(nodes::light_ambient(), R"({"color": [-0.1, 0, 0]})"), std::invalid_argument);
  EXPECT_THROW(test::params_of(nodes::light_ambient(), R"({"color": -0.1})"), std::invalid_argument);
}

}  // namespace
}  // namespace frustum
