// shade.shadow against shadows in closed form, and what shade.surface makes of them.
#include "nodes/kernels/vector.h"
#include "tests/nodes/shade/shadow_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace frustum {
namespace {

using test::Floor, test::Plate, test::PixelRun, test::sun;

const Plate plate{-1, 1.5F, -0.5F, 1, 1.25F};

PixelRun shadow(const Floor& floor, const Ref<Mesh>& casters, std::vector<Buffer> lights,
                Precision precision = Precision::single) {
  return {nodes::shade_shadow(),
          "{}",
          {{"points", {floor.points()}},
           {"mesh", {floor.mesh()}},
           {"casters", {casters}},
           {"lights", std::move(lights)}},
          precision};
}

TEST(ShadeShadow, IsTheProjectionOfAPlateForTheSunAndForALamp) {
  const Floor floor;
  const glm::dvec3 lamp(0.3, 3, -0.4);
  const Buffer point = one_light({.kind = Light::Kind::point, .position = lamp});
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const Raster seen =
        shadow(floor, floor.with(plate.triangles()), {sun({1, 2, 0.5}), point}, precision).whole();
    ASSERT_EQ(seen.frame().planes.size(), 2u);
    int dark = 0;
    for (int y = 0; y < floor.edge; ++y)
      for (int x = 0; x < floor.edge; ++x) {
        const glm::dvec3 p = floor.at(x, y);
        const bool by_sun = plate.depth_in_shadow(p, {1, 2, 0.5}) > 0,
                   by_lamp = plate.depth_in_shadow(p, lamp - p) > 0;
        const auto at = [&](int plane) {
          return precision == Precision::single ? seen.at<float>(plane, 0, x, y)
                                                : seen.at<double>(plane, 0, x, y);
        };
        ASSERT_EQ(at(0), by_sun ? 0 : 1) << x << " " << y;
        ASSERT_EQ(at(1), by_lamp ? 0 : 1) << x << " " << y;
        dark += by_sun + by_lamp;
      }
    EXPECT_GT(dark, 1000);
  }
}

// The course's row 76: under a lamp at height H a disc of radius r at height h has a round shadow, of radius r H / (H - h).
// What lies above the lamp casts none (errata E45): a second disc there, wider, changes nothing.
TEST(ShadeShadow, ADiscUnderALampHasARoundShadowOfItsRadius) {
  const double lamp_height = 3, height = 1.2, radius = 0.8,
               shadow_radius = radius * lamp_height / (lamp_height - height);
  constexpr int sides = 720;
  const auto disc = [](double r, double y) {
    std::vector<glm::vec3> fan;
    for (int i = 0; i < sides; ++i) {
      const auto rim = [&](int k) {
        const double a = 2 * std::numbers::pi * k / sides;
        return glm::vec3(r * std::cos(a), y, r * std::sin(a));
      };
      fan.insert(fan.end(), {glm::vec3(0, y, 0), rim(i + 1), rim(i)});
    }
    return fan;
  };
  std::vector<glm::vec3> both = disc(radius, height), above = disc(3, lamp_height + 0.1);
  both.insert(both.end(), above.begin(), above.end());
  const Floor floor;
  const Buffer lamp = one_light({.kind = Light::Kind::point, .position = {0, lamp_height, 0}});
  const Raster seen = shadow(floor, floor.with(both), {lamp}).whole();
  const double within =
      shadow_radius * std::cos(std::numbers::pi / sides) - 1e-5;  // of the polygon that the disc is
  int dark = 0;
  for (int y = 0; y < floor.edge; ++y)
    for (int x = 0; x < floor.edge; ++x) {
      const glm::dvec3 p = floor.at(x, y);
      const double r = std::hypot(p.x, p.z);
      if (r > within && r < shadow_radius + 1e-5) continue;
      ASSERT_EQ(seen.at<float>(0, 0, x, y), r < shadow_radius ? 0 : 1) << x << ' ' << y;
      dark += r < shadow_radius;
    }
  EXPECT_NEAR(dark * std::pow(2 * floor.size / floor.edge, 2),
              std::numbers::pi * shadow_radius * shadow_radius, 0.1);
}

TEST(ShadeShadow, KeepsTheLawOfTiles) {
  const Floor floor{.size = 3, .edge = 43};
  EXPECT_EQ(test::break_of_tile_law(shadow(floor, floor.with(plate.triangles()), {sun({1, 2, 0.5})})), "");
}

// Points of a floor far from the origin lie up to 2^-8 above and below it once they are float: they must not hide
// one another. The naive test, any crossing at t > 0, darkens a good part of them.
TEST(ShadeShadow, AFloorDoesNotHideItselfHoweverTheNumbersRound) {
  const auto far = [](const glm::vec3& p) {
    return glm::vec3(100000.0F + p.x, 31234.0F + 0.3717F * p.x - 0.2113F * p.z, -70000.0F + p.z);
  };
  const Floor floor{.size = 49.7, .edge = 61};
  std::vector<glm::vec3> corner;
  for (const glm::vec3& p : floor.corners()) corner.push_back(far(p));
  Mesh mesh = test::mesh_of(corner, Floor::faces(), Space::world);
  mesh.columns.push_back(Column::make<glm::vec3>("world", Domain::vertex, corner, Space::world));
  auto points = std::make_shared<Image>(*floor.points());
  int off = 0;
  for (int y = 0; y < floor.edge; ++y)
    for (int x = 0; x < floor.edge; ++x) {
      const glm::vec3 p = far(glm::vec3(floor.at(x, y)));
      for (int k = 0; k < 3; ++k) points->raster.view().row<float>(4 + k, 0, y)[x] = p[k];
      const glm::dvec3 n = kernels::cross(glm::dvec3(corner[1]) - glm::dvec3(corner[0]),
                                          glm::dvec3(corner[2]) - glm::dvec3(corner[0]));
      off += kernels::dot(n, glm::dvec3(p) - glm::dvec3(corner[0])) < 0;
    }
  EXPECT_GT(off, 500) << "many points lie under their floor, and a ray from there would meet it";
  const PixelRun run(nodes::shade_shadow(), "{}",
                     {{"points", {std::static_pointer_cast<const Image>(points)}},
                      {"mesh", {test::shared(mesh)}},
                      {"casters", {test::shared(mesh)}},
                      {"lights", {sun({-0.8, 1, 0.3}), sun({5, 2, 0})}}});
  // Nothing stands in front of the floor, but the second sun is too low to say so of this many digits.
  const Raster seen = run.whole();
  for (std::size_t plane = 0; plane < seen.frame().planes.size(); ++plane)
    for (int y = 0; y < floor.edge; ++y)
      for (int x = 0; x < floor.edge; ++x) ASSERT_EQ(seen.at<float>(static_cast<int>(plane), 0, x, y), 1.0F);
}

TEST(ShadeShadow, LightsThatNothingCanHideHaveNoPlane) {
  const Floor floor;
  EXPECT_EQ(shadow(floor, floor.mesh(), {sun({1, 2, 0.5})}).frame().planes.size(), 0u) << "the floor alone";
  const Frame some = shadow(floor, floor.with(plate.triangles()),
                            {one_light({.kind = Light::Kind::ambient}), sun({1, 2, 0.5}), sun({0, -1, 0})})
                         .frame();
  ASSERT_EQ(some.planes.size(), 2u) << "ambient light is not counted";
  EXPECT_EQ(some.planes[1].name, "V1");
  const Plate below{-1, 1, -1, 1, -1};
  EXPECT_EQ(shadow(floor, floor.with(below.triangles()), {sun({1, 2, 0.5})}).frame().planes.size(), 0u);
}

// Every way of shading: light times what of it arrives, one light after the other.
TEST(ShadeShadow, SurfacesGetWhatReachesThemOfEachLight) {
  const Floor floor{.size = 4, .edge = 40};
  auto mesh = std::make_shared<Mesh>(*floor.mesh());
  const std::vector<glm::vec3> up(4, {0, 1, 0});
  std::vector<glm::vec4> screen;
  for (const glm::vec3& p : floor.corners()) screen.emplace_back(5 * p.x + 20, 5 * p.z + 20, 0, 1);
  mesh->columns.push_back(Column::make<glm::vec3>("normal", Domain::vertex, up, Space::world));
  mesh->columns[1] = Column::make<glm::vec4>("position", Domain::vertex, screen, Space::screen);
  mesh->camera = std::make_shared<Camera>(Camera{.eye = {0, 10, 0}});
  const std::vector<Buffer> lights{sun({1, 2, 0.5}), one_light({.color = {0.1, 0.1, 0.1}}), sun({-2, 2, 1})};
  const PixelRun seen(nodes::shade_shadow(), "{}",
                      {{"points", {floor.points()}},
                       {"mesh", {Ref<Mesh>(mesh)}},
                       {"casters", {floor.with(plate.triangles())}},
                       {"lights", lights}});
  const Buffer visibility = std::make_shared<const Image>(Image{seen.whole()});
  const Buffer shiny = std::make_shared<const Material>(Material{
      .model = Reflection::blinn, .diffuse = glm::dvec3{0.5}, .specular = glm::dvec3{0.5}, .shininess = 8});
  const auto lit = [&](const char* interpolation, std::vector<Buffer> by, bool shadows) {
    test::NodeInputs in{{"points", {floor.points()}},
                        {"mesh", {Ref<Mesh>(mesh)}},
                        {"material", {shiny}},
                        {"lights", std::move(by)}};
    if (shadows) in["visibility"] = {visibility};
    return PixelRun(nodes::shade_surface(), std::string(R"({"interpolation": ")") + interpolation + R"("})",
                    in);
  };
  for (const char* interpolation : {"flat", "gouraud", "phong"}) {
    const PixelRun run = lit(interpolation, lights, true);
    EXPECT_EQ(test::break_of_tile_law(run), "") << interpolation;
    const Raster all = run.whole(), first = lit(interpolation, {lights[0]}, false).whole(),
                 second = lit(interpolation, {lights[1]}, false).whole(),
                 third = lit(interpolation, {lights[2]}, false).whole();
    for (int y = 0; y < floor.edge; ++y)
      for (int x = 0; x < floor.edge; ++x) {
        const auto& v = visibility.as<Image>()->raster;
        const float want = first.at<float>(0, 0, x, y) * v.at<float>(0, 0, x, y) +
                           second.at<float>(0, 0, x, y) +
                           third.at<float>(0, 0, x, y) * v.at<float>(1, 0, x, y);
        ASSERT_NEAR(all.at<float>(0, 0, x, y), want, 4e-7F) << interpolation << " " << x << " " << y;
      }
  }
}

TEST(ShadeShadow, VisibilityOfOtherLightsIsRefused) {
  const Floor floor{.size = 4, .edge = 8};
  const PixelRun seen = shadow(floor, floor.with(plate.triangles()), {sun({1, 2, 0.5}), sun({-1, 2, 0.5})});
  try {
    PixelRun(nodes::shade_surface(), "{}",
             {{"points", {floor.points()}},
              {"mesh", {floor.mesh()}},
              {"visibility", {std::make_shared<const Image>(Image{seen.whole()})}},
              {"lights", {sun({1, 2, 0.5})}}});
    FAIL();
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "other_lights");
    EXPECT_EQ(e.part, "/in/visibility");
  }
}

}  // namespace
}  // namespace frustum
