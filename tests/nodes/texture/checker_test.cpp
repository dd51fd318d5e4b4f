#include "nodes/texture.h"
#include "runtime/buffers/texture.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

TEST(TextureChecker, HoldsItsScaleAndColours) {
  const auto made =
      test::run_geometry(nodes::texture_checker(), R"({"scale": 12, "even": [1, 0.5, 0], "odd": 0.25})", {});
  const auto& c = std::get<Checker>(made.at(0).as<Texture>()->source);
  EXPECT_EQ(c.scale, 12);
  EXPECT_EQ(c.even, glm::dvec3(1, 0.5, 0));
  EXPECT_EQ(c.odd, glm::dvec3(0.25));
}

TEST(TextureChecker, RefusesSquaresWithoutSize) {
  EXPECT_THROW(test::params_of(nodes::texture_checker(), R"({"scale": 0})"), std::invalid_argument);
  EXPECT_THROW(test::params_of(nodes::texture_checker(), R"({"even": [-1, 0, 0]})"), std::invalid_argument);
}

}  // namespace
}  // namespace frustum
