// shade.surface: the three interpolations, its rates, and what it takes from material, lights and albedo.
#include "nodes/shade.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "tests/support/tiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace frustum {
namespace {

// ----- the node: a picture of the unit sphere from z = 1000 by an orthographic eye, made here by formula

struct Shot {
  Ref<Image> points;
  Ref<Mesh> mesh;
};

// `split`: which of two faces a sample sees, so that pixels see several.
Shot sphere(int size, int samples, PlaneKind kind = PlaneKind::f32) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = samples;
  pattern->x.clear(), pattern->y.clear();
  for (int s = 0; s < samples; ++s) {
    pattern->x.push_back(static_cast<std::uint16_t>((s * 4096 + 2048) / samples));
    pattern->y.push_back(static_cast<std::uint16_t>((s * 5 % samples) * 4096 / samples));
  }
  Frame f{.window = {0, 0, size, size}, .pattern = pattern, .planes = {{"id", PlaneKind::u32}}};
  for (const char* name : {"N.x", "N.y", "N.z", "P.x", "P.y", "P.z"}) f.planes.push_back({name, kind});
  Raster r(f);
  for (int s = 0; s < samples; ++s)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const auto i = static_cast<std::size_t>(s);
        const double px = 2 * (x + pattern->x[i] / 4096.0) / size - 1,
                     py = 1 - 2 * (y + pattern->y[i] / 4096.0) / size;
        const double zz = 1 - px * px - py * py;
        r.view().row<std::uint32_t>(0, s, y)[x] = zz < 0 ? no_face : (px + py > 0 ? 1u : 0u);
        if (zz < 0) continue;
        const double value[6] = {px, py, std::sqrt(zz), px, py, std::sqrt(zz)};
        for (int k = 0; k < 6; ++k) {
          if (kind == PlaneKind::f64)
            r.view().row<double>(1 + k, s, y)[x] = value[k];
          else
            r.view().row<float>(1 + k, s, y)[x] = static_cast<float>(value[k]);
        }
      }
  // Two triangles over the whole picture, facing the eye; the second one has the second material.
  auto mesh = std::make_shared<Mesh>();
  const glm::vec4 screen[4] = {{0, 0, 0, 1}, {0, size, 0, 1}, {size, size, 0, 1}, {size, 0, 0, 1}};
  const glm::vec3 world[4] = {{-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}};
  const glm::vec3 normal[4] = {{-0.6F, 0, 0.8F}, {0, 0, 1}, {0.6F, 0, 0.8F}, {0, 0.6F, 0.8F}};
  const glm::uvec3 triangle[2] = {{0, 1, 2}, {0, 2, 3}};
  const std::uint32_t material[2] = {0, 1};
  mesh->columns = {Column::make<glm::vec4>("position", Domain::vertex, screen, Space::screen),
                   Column::make<glm::vec3>("world", Domain::vertex, world, Space::world),
                   Column::make<glm::vec3>("normal", Domain::vertex, normal, Space::world),
                   Column::make<glm::uvec3>("triangle", Domain::face, triangle),
                   Column::make<std::uint32_t>("material", Domain::face, material)};
  auto set = std::make_shared<MaterialSet>();
  set->materials = {Material{.diffuse = {1, 0, 0}},
                    Material{.diffuse = {0, 1, 0}, .specular = glm::dvec3{0.5}, .shininess = 60}};
  mesh->materials = set;
  mesh->camera = std::make_shared<Camera>(Camera{.eye = {0, 0, 1000}});
  return {std::make_shared<Image>(Image{r}), mesh};
}

Buffer directional(const glm::dvec3& direction) {
  return one_light({.kind = Light::Kind::directional, .direction = direction});
}

Buffer white(Reflection model = Reflection::lambert, double specular = 0) {
  return std::make_shared<const Material>(
      Material{.model = model, .diffuse = glm::dvec3{1}, .specular = glm::dvec3{specular}});
}

TEST(ShadeSurface, KeepsTheLawOfTilesInEveryMode) {
  const Shot shot = sphere(43, 4);
  for (const char* interpolation : {"flat", "gouraud", "phong"})
    for (const char* rate : {"sample", "pixel"})
      for (const char* two_sided : {"false", "true"}) {
        const std::string params = std::string(R"({"interpolation": ")") + interpolation + R"(", "rate": ")" +
                                   rate + R"(", "two_sided": )" + two_sided + "}";
        const test::PixelRun run(
            nodes::shade_surface(), params,
            {{"points", {shot.points}}, {"mesh", {shot.mesh}}, {"lights", {directional({0, 0, -1})}}});
        EXPECT_EQ(test::break_of_tile_law(run), "") << params;
      }
}

// A quarter is a power of two: the colours of the opaque picture, exactly.
TEST(ShadeSurface, OpacityScalesColourAndAlpha) {
  const Shot shot = sphere(33, 4);
  auto mesh = std::make_shared<Mesh>(*shot.mesh);
  const float transparency[2] = {0, 0.75F};
  mesh->columns.push_back(Column::make<float>("transparency", Domain::face, transparency));
  const auto lit = [&](const Ref<Mesh>& seen, const char* rate, bool one_material) {
    test::NodeInputs in{{"points", {shot.points}}, {"mesh", {seen}}, {"lights", {directional({0, 0, -1})}}};
    if (one_material) in["material"] = {white()};
    return test::PixelRun(nodes::shade_surface(), std::string(R"({"rate": ")") + rate + R"("})", in).whole();
  };
  for (const char* rate : {"sample", "pixel"})
    for (const bool one_material : {false, true}) {
      const Raster opaque = lit(shot.mesh, rate, one_material), some = lit(mesh, rate, one_material);
      for (int s = 0; s < 4; ++s)
        for (int y = 0; y < 33; ++y)
          for (int x = 0; x < 33; ++x)
            for (int c = 0; c < 4; ++c) {
              const bool second = shot.points->raster.at<std::uint32_t>(0, s, x, y) == 1;
              ASSERT_EQ(some.at<float>(c, s, x, y), opaque.at<float>(c, s, x, y) * (second ? 0.25F : 1.0F))
                  << rate;
            }
    }
}

TEST(ShadeSurface, LambertIsTheCosineAndAlphaIsCoverage) {
  const Shot shot = sphere(64, 1);
  const Raster image = test::PixelRun(nodes::shade_surface(), "{}",
                                      {{"points", {shot.points}},
                                       {"mesh", {shot.mesh}},
                                       {"material", {white()}},
                                       {"lights", {directional({0, 0, -1})}}})
                           .whole();
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const bool covered = shot.points->raster.at<std::uint32_t>(0, 0, x, y) != no_face;
      EXPECT_NEAR(image.at<float>(1, 0, x, y), covered ? shot.points->raster.at<float>(3, 0, x, y) : 0.0F,
                  3e-7F);
      EXPECT_EQ(image.at<float>(3, 0, x, y), covered ? 1.0F : 0.0F);
    }
}

TEST(ShadeSurface, MaterialsFollowFacesAndAlbedoScalesThem) {
  const Shot shot = sphere(32, 1);
  Frame f{.window = {0, 0, 32, 32},
          .pattern = shot.points->raster.frame().pattern,
          .planes = {{"R"}, {"G"}, {"B"}}};
  Raster albedo(f);
  for (int p = 0; p < 3; ++p)
    for (int y = 0; y < 32; ++y) std::fill_n(albedo.view().row<float>(p, 0, y), 32, 0.5F);
  const test::NodeInputs in{
      {"points", {shot.points}}, {"mesh", {shot.mesh}}, {"lights", {directional({0, 0, -1})}}};
  auto with = in;
  with["albedo"] = {std::make_shared<const Image>(Image{albedo})};
  const Raster plain = test::PixelRun(nodes::shade_surface(), "{}", in).whole();
  const Raster half = test::PixelRun(nodes::shade_surface(), "{}", with).whole();
  EXPECT_GT(plain.at<float>(0, 0, 10, 20), 0.5F);
  EXPECT_EQ(plain.at<float>(1, 0, 10, 20), 0.0F) << "face 0 is red";
  EXPECT_EQ(half.at<float>(0, 0, 10, 20), 0.5F * plain.at<float>(0, 0, 10, 20));
  EXPECT_GT(plain.at<float>(1, 0, 20, 10), 0.5F) << "face 1 is green";
  EXPECT_GT(plain.at<float>(0, 0, 16, 15), 0.4F) << "with a white highlight in the middle";
}

TEST(ShadeSurface, EmissionIsAddedAndWhatIsKnownToBeWhiteIsNotRead) {
  const Shot shot = sphere(16, 1);
  auto mesh = std::make_shared<Mesh>(*shot.mesh);
  auto set = std::make_shared<MaterialSet>(*mesh->materials);
  set->materials[0].emission = {0.25, 0, 4};
  mesh->materials = set;
  const test::NodeInputs in{
      {"points", {shot.points}}, {"mesh", {shot.mesh}}, {"lights", {directional({0, 0, -1})}}};
  auto glowing = in;
  glowing["mesh"] = {Ref<Mesh>(mesh)};
  const Raster plain = test::PixelRun(nodes::shade_surface(), "{}", in).whole();
  const Raster glows = test::PixelRun(nodes::shade_surface(), "{}", glowing).whole();
  EXPECT_EQ(glows.at<float>(0, 0, 5, 10), plain.at<float>(0, 0, 5, 10) + 0.25F);
  EXPECT_EQ(glows.at<float>(2, 0, 5, 10), 4.0F);
  EXPECT_EQ(glows.at<float>(2, 0, 10, 5), plain.at<float>(2, 0, 10, 5)) << "the other material";
}

TEST(ShadeSurface, LightsOfOneLinkAndOfSeveralAreTheSame) {
  const Shot shot = sphere(16, 1);
  const Light a{.kind = Light::Kind::directional, .color = glm::dvec3{0.5}, .direction = {0, 0, -1}},
      b{.kind = Light::Kind::point, .position = {0, 1, 3}}, c{.kind = Light::Kind::ambient};
  const auto both = std::make_shared<const LightSet>(LightSet{{a, b, c}});
  const auto picture = [&](std::vector<Buffer> lights) {
    return Buffer(std::make_shared<const Image>(Image{
                      test::PixelRun(nodes::shade_surface(), "{}",
                                     {{"points", {shot.points}}, {"mesh", {shot.mesh}}, {"lights", lights}})
                          .whole()}))
        .digest();
  };
  EXPECT_EQ(picture({both}), picture({one_light(a), one_light(b), one_light(c)}));
  EXPECT_NE(picture({both}), picture({one_light(a), one_light(b)}));
}

TEST(ShadeSurface, OnlyTwoSidedMaterialsAreLitFromBehind) {
  const Shot shot = sphere(16, 1);
  auto mesh = std::make_shared<Mesh>(*shot.mesh);
  auto set = std::make_shared<MaterialSet>(*mesh->materials);
  set->materials[0].two_sided = true;
  mesh->materials = set;
  mesh->camera = std::make_shared<Camera>(Camera{.eye = {0, 0, -1000}});  // behind both faces
  const Raster image =
      test::PixelRun(
          nodes::shade_surface(), "{}",
          {{"points", {shot.points}}, {"mesh", {Ref<Mesh>(mesh)}}, {"lights", {directional({0, 0, 1})}}})
          .whole();
  EXPECT_GT(image.at<float>(0, 0, 5, 10), 0.5F) << "face 0 is turned to the eye, and to the light";
  EXPECT_EQ(image.at<float>(1, 0, 10, 5), 0.0F) << "face 1 is not";
}

TEST(ShadeSurface, OnceAPixelGivesEverySampleOfAFaceOneColour) {
  const Shot shot = sphere(40, 8);
  const test::NodeInputs in{
      {"points", {shot.points}}, {"mesh", {shot.mesh}}, {"lights", {directional({0.5, -0.5, -0.7})}}};
  for (const char* interpolation : {"flat", "gouraud", "phong"}) {
    const std::string params = std::string(R"({"interpolation": ")") + interpolation + R"(", "rate": )";
    const Raster pixel = test::PixelRun(nodes::shade_surface(), params + R"("pixel"})", in).whole();
    const Raster sample = test::PixelRun(nodes::shade_surface(), params + R"("sample"})", in).whole();
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        std::map<std::uint32_t, std::set<float>> colors;
        for (int s = 0; s < 8; ++s) {
          const auto id = shot.points->raster.at<std::uint32_t>(0, s, x, y);
          const float c = pixel.at<float>(id == 0 ? 0 : 1, s, x, y);
          colors[id].insert(c);
          EXPECT_EQ(pixel.at<float>(3, s, x, y), sample.at<float>(3, s, x, y));
          if (interpolation == std::string("flat")) {
            EXPECT_NEAR(c, sample.at<float>(id == 0 ? 0 : 1, s, x, y), 1e-6);
          }
        }
        for (const auto& [id, distinct] : colors)
          EXPECT_EQ(distinct.size(), 1u) << interpolation << " face " << id;
      }
  }
}

TEST(ShadeSurface, FlatGivesOneColourAFace) {
  const Shot shot = sphere(32, 2);
  const Raster image = test::PixelRun(nodes::shade_surface(), R"({"interpolation": "flat"})",
                                      {{"points", {shot.points}},
                                       {"mesh", {shot.mesh}},
                                       {"material", {white()}},
                                       {"lights", {directional({0, 0, -1})}}})
                           .whole();
  std::set<float> colors;
  for (int s = 0; s < 2; ++s)
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x)
        if (image.at<float>(3, s, x, y) == 1) colors.insert(image.at<float>(0, s, x, y));
  EXPECT_EQ(colors, std::set<float>{1.0F});  // both triangles lie in z = 0 and face the light
}

TEST(ShadeSurface, GouraudIsLinearBetweenItsVertices) {
  const Shot shot = sphere(32, 1);
  const Raster image = test::PixelRun(nodes::shade_surface(), R"({"interpolation": "gouraud"})",
                                      {{"points", {shot.points}},
                                       {"mesh", {shot.mesh}},
                                       {"material", {white()}},
                                       {"lights", {directional({0, 0, -1})}}})
                           .whole();
  // Vertices receive 0.8, 1, 0.8, 0.8; in face 0 (the lower left) the middle one has the share below the
  // diagonal.
  for (int y = 8; y < 28; ++y)
    for (int x = 4; x < 28; ++x) {
      if (shot.points->raster.at<std::uint32_t>(0, 0, x, y) != 0) continue;
      const double sy = shot.points->raster.frame().pattern->y[0] / 4096.0;
      const double share = (y + sy - (x + 0.5)) / 32;
      EXPECT_NEAR(image.at<float>(0, 0, x, y), 0.8 + 0.2 * std::clamp(share, 0.0, 1.0), 1e-6);
    }
}

TEST(ShadeSurface, GouraudMissesAHighlightInsideAFace) {
  // All vertex normals turn away from the half vector; Phong's interpolated ones meet it in the middle.
  Shot shot = sphere(64, 1);
  const test::NodeInputs in{{"points", {shot.points}},
                            {"mesh", {shot.mesh}},
                            {"material", {white(Reflection::blinn, 1)}},
                            {"lights", {directional({0, -0.6, -0.8})}}};
  const auto brightest = [&](const char* params) {
    const Raster image = test::PixelRun(nodes::shade_surface(), params, in).whole();
    float most = 0;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) most = std::max(most, image.at<float>(0, 0, x, y));
    return most;
  };
  EXPECT_GT(brightest(R"({"interpolation": "phong"})"), brightest(R"({"interpolation": "gouraud"})") + 0.2F);
}

TEST(ShadeSurface, AFaceSeenFromBehindIsLitOnlyWithTwoSides) {
  Shot shot = sphere(16, 1);
  auto mesh = std::make_shared<Mesh>(*shot.mesh);
  mesh->camera = std::make_shared<Camera>(Camera{.eye = {0, 0, -1000}});
  const test::NodeInputs in{{"points", {shot.points}},
                            {"mesh", {Ref<Mesh>(mesh)}},
                            {"material", {white()}},
                            {"lights", {directional({0, 0, 1})}}};
  EXPECT_EQ(test::PixelRun(nodes::shade_surface(), "{}", in).whole().at<float>(0, 0, 8, 8), 0.0F);
  for (const char* interpolation : {"flat", "gouraud", "phong"}) {
    const std::string params =
        std::string(R"({"two_sided": true, "interpolation": ")") + interpolation + "\"}";
    EXPECT_GT(test::PixelRun(nodes::shade_surface(), params, in).whole().at<float>(0, 0, 8, 8), 0.7F)
        << interpolation;
  }
}

TEST(ShadeSurface, AmbientLightAddsWhateverElseThereIs) {
  const Shot shot = sphere(16, 1);
  const Buffer ambient = one_light({.kind = Light::Kind::ambient, .color = {0.25, 0.5, 0}});
  const test::NodeInputs base{{"points", {shot.points}}, {"mesh", {shot.mesh}}, {"material", {white()}}};
  auto in = base;
  in["lights"] = {ambient};
  const Raster image = test::PixelRun(nodes::shade_surface(), "{}", in).whole();
  EXPECT_EQ(image.at<float>(0, 0, 8, 8), 0.25F);
  EXPECT_EQ(image.at<float>(1, 0, 8, 8), 0.5F);
  EXPECT_EQ(image.at<float>(1, 0, 0, 0), 0.0F);
  EXPECT_EQ(test::PixelRun(nodes::shade_surface(), "{}", base).whole().at<float>(0, 0, 8, 8), 0.0F)
      << "no light at all";
}

TEST(ShadeSurface, DoubleFollowsSingleAndReadsSinglePlanes) {
  const Shot narrow = sphere(24, 2), wide = sphere(24, 2, PlaneKind::f64);
  for (const char* rate : {R"({"rate": "sample"})", R"({"rate": "pixel"})"}) {
    const auto run = [&](const Shot& shot, Precision precision) {
      return test::PixelRun(nodes::shade_surface(), rate,
                            {{"points", {shot.points}},
                             {"mesh", {narrow.mesh}},
                             {"material", {white(Reflection::phong, 0.5)}},
                             {"lights", {directional({0, -0.6, -0.8})}}},
                            precision)
          .whole();
    };
    const Raster single = run(narrow, Precision::single), exact = run(wide, Precision::real_double),
                 widened = run(narrow, Precision::real_double);
    EXPECT_EQ(exact.frame().planes[0].kind, PlaneKind::f64);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x) {
        EXPECT_NEAR(single.value(1, 1, x, y), exact.value(1, 1, x, y), 1e-5);
        EXPECT_NEAR(widened.value(1, 1, x, y), exact.value(1, 1, x, y), 1e-5);
      }
  }
}

TEST(ShadeSurface, SaysWhatIsMissing) {
  const Shot shot = sphere(8, 1);
  const auto code_of = [&](const char* params, test::NodeInputs in) -> std::string {
    try {
      test::PixelRun(nodes::shade_surface(), params, std::move(in));
    } catch (const NodeError& e) {
      return e.code;
    }
    return "";
  };
  auto bare = std::make_shared<Mesh>(*shot.mesh);
  bare->camera = nullptr;
  EXPECT_EQ(code_of("{}", {{"points", {shot.points}},
                           {"mesh", {Ref<Mesh>(bare)}},
                           {"material", {white(Reflection::phong, 1)}}}),
            "missing_camera");
  const Ref<Image> ids = std::make_shared<Image>(
      Image{Raster(Frame{.window = {0, 0, 8, 8}, .planes = {{"id", PlaneKind::u32}}})});
  EXPECT_EQ(code_of("{}", {{"points", {ids}}, {"mesh", {shot.mesh}}}), "missing_normals");
  EXPECT_EQ(code_of(R"({"interpolation": "flat"})", {{"points", {ids}}, {"mesh", {shot.mesh}}}), "");
}

}  // namespace
}  // namespace frustum
