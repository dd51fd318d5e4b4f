#include "nodes/light.h"
#include "runtime/buffers/light.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>

namespace frustum {
namespace {

TEST(LightDirectional, DirectionHasUnitLengthWhateverItsSize) {
  for (const char* direction : {"[0, -3, 4]", "[0, -3e-200, 4e-200]", "[0, -3e200, 4e200]"}) {
    const auto light =
        test::run_geometry(nodes::light_directional(), std::string(R"({"direction": )") + direction + "}", {})
            .at(0)
            .as<LightSet>()
            ->lights.at(0);
    EXPECT_EQ(light.kind, Light::Kind::directional);
    EXPECT_DOUBLE_EQ(light.direction.y, -0.6) << direction;
    EXPECT_DOUBLE_EQ(light.direction.z, 0.8) << direction;
  }
}

TEST(LightDirectional, ADirectionOfNoLengthIsAnError) {
  try {
    test::run_geometry(nodes::light_directional(), R"({"direction": [0, 0, 0]})", {});
    FAIL() << "no error";
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "zero_direction");
  }
}

}  // namespace
}  // namespace frustum
