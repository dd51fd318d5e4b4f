#include "runtime/buffers/material.h"
#include "nodes/kernels/lighting.h"
#include "nodes/shade.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>

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
  EXPECT_EQ(warnings(R"({"diffuse": 0.7, "specular": 0.4, "shininess": 60})"), 0u);
  EXPECT_EQ(warnings(R"({"diffuse": 0.7, "specular": 0.4, "shininess": 1})"), 1u)
      << "a lobe as wide as the hemisphere";
  EXPECT_EQ(warnings(R"({"diffuse": 0.99, "specular": 0.4, "shininess": 60})"), 1u);
  EXPECT_EQ(warnings(R"({"diffuse": 0.99, "specular": 0.4, "shininess": 60, "model": "lambert"})"), 0u);
}

TEST(ShadeMaterial, ReflectanceIsTheIntegralOfTheLobe) {
  const kernels::LightSource<double> light{false, {1, 1, 1}, {0, 0, 1}, {}};
  for (const auto kind : {kernels::Highlight::phong, kernels::Highlight::blinn})
    for (const double e : {0.0, 1.0, 7.5, 60.0}) {
      kernels::LightSetup<double> s{{&light, 1}, {}, kind, kernels::Exponent<double>(e)};
      const int n = 4000;
      double sum =
          0;  // over z = cos(theta): integral of f cos / pi over the hemisphere = integral of 2 f z dz
      for (int i = 0; i < n; ++i) {
        const double z = (i + 0.5) / n;
        s.eye = {std::sqrt(1 - z * z), 0, z};
        sum += 2 * z / n * kernels::receive(s, {0, 0, 1}, {0, 0, 0}).specular[0];
      }
      const double want =
          kind == kernels::Highlight::phong ? 2 / (e + 2) : 8 * (e + std::exp2(-e / 2)) / ((e + 2) * (e + 4));
      EXPECT_NEAR(sum, want, 1e-4) << e;  // the midpoint rule over 1/n^2, and the jump of cos^0
    }
}

TEST(ShadeMaterial, RefusesNegativeShininess) {
  EXPECT_THROW(test::params_of(nodes::shade_material(), R"({"shininess": -1})"), std::invalid_argument);
}

}  // namespace
}  // namespace frustum
