#include "runtime/buffers/material.h"
#include "nodes/all_nodes.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

namespace frustum {
namespace {

TEST(ShadeMaterial, TakesANumberForAGreyHighlight) {
  const auto m =
      test::run_geometry(
          nodes::shade_material(),
          R"({"diffuse": [0.5, 0.3, 0.2], "specular": 0.4, "shininess": 60, "model": "phong"})", {})
          .at(0)
          .as<Material>();
  EXPECT_EQ(m->model, Reflection::phong);
  EXPECT_EQ(m->diffuse, glm::dvec3(0.5, 0.3, 0.2));
  EXPECT_EQ(m->specular, glm::dvec3(0.4));
  EXPECT_EQ(m->shininess, 60);
}

TEST(ShadeMaterial, SaysWhereTheSurfaceMakesLight) {
  const auto warnings = [](const char* params) {
    Context ctx;
    test::run_geometry(nodes::shade_material(), params, {}, Precision::single, &ctx);
    return ctx.warnings().size();
  };
  EXPECT_EQ(warnings(R"({"diffuse": 0.6, "specular": 0.5})"), 1u);
  EXPECT_EQ(warnings(R"({"diffuse": 0.6, "specular": 0.4})"), 0u);
  EXPECT_EQ(warnings(R"({"diffuse": 0.6, "specular": 0.5, "model": "lambert"})"), 0u);
}

TEST(ShadeMaterial, RefusesNegativeShininess) {
  EXPECT_THROW(test::params_of(nodes::shade_material(), R"({"shininess": -1})"), std::invalid_argument);
}

}  // namespace
}  // namespace frustum
