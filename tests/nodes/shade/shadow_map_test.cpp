// shade.shadow_map: maps by formula, shadows in closed form outside a band of a texel, and the two ways to be wrong.
#include "nodes/shade/shadow_map.h"
#include "nodes/light/camera.h"
#include "runtime/buffers/camera.h"
#include "tests/nodes/shade/shadow_scenes.h"
#include "tests/support/clip_spaces.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace frustum {
namespace {

using glm::dvec3;
using test::Floor, test::Plate, test::PixelRun, test::sun;

// What a directional light's camera sees at the middle of every texel.
struct SunMap {
  Camera camera;
  shadow_map::View view;
  Ref<Depth> depth;
  double texel;  // world units
};

// `hit` gives the nearest point along the light from a place before everything, if there is one.
SunMap sun_map(const dvec3& to_light, const std::vector<glm::vec3>& casters, int size,
               const std::function<std::optional<dvec3>(const dvec3&)>& hit,
               Conventions conventions = Conventions::gl) {
  const std::vector<dvec3> wide(casters.begin(), casters.end());
  const dvec3 travel = -kernels::normalized(to_light).value();
  const light_camera::View v = light_camera::parallel_view(travel, wide, size);
  Camera camera{
      .eye = v.eye, .target = v.target, .up = v.up, .near_z = v.near_z, .far_z = v.far_z, .height = v.height};
  camera.resolution = glm::ivec2(size);
  camera.conventions = conventions;
  const shadow_map::View view{kernels::look_at(v.eye, v.target, v.up).eye_from_world,
                              kernels::orthographic(v.height, 1, v.near_z, v.far_z, clip_space(&camera)),
                              viewport_of(camera)};
  Raster r(Frame{.window = {0, 0, size, size}, .planes = {{"Z"}}});
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const glm::dvec2 ndc = view.viewport.ndc_from_px({x + 0.5, y + 0.5});
      const dvec3 p_eye(ndc.x / view.volume.scale.x, ndc.y / view.volume.scale.y, 0);
      const auto at =
          hit(view.eye_from_world.inverse_linear * p_eye + view.eye_from_world.inverse_translation);
      const auto seen = at ? shadow_map::seen_from_light(view, {}, *at) : std::nullopt;
      r.view().row<float>(0, 0, y)[x] = seen ? static_cast<float>(seen->z) : 1.0F;
    }
  return {camera, view, std::make_shared<const Depth>(Depth{r}), v.height / size};
}

SunMap map_of(const Floor& floor, const Plate& plate, const dvec3& to_light, int size,
              Conventions conventions = Conventions::gl) {
  std::vector<glm::vec3> casters = floor.corners();
  for (const glm::vec3& p : plate.triangles()) casters.push_back(p);
  return sun_map(
      to_light, casters, size,
      [&](const dvec3& from) -> std::optional<dvec3> {
        const dvec3 on_plate = from - to_light * ((from.y - plate.y) / to_light.y);
        if (on_plate.x > plate.x0 && on_plate.x < plate.x1 && on_plate.z > plate.z0 && on_plate.z < plate.z1)
          return on_plate;
        const dvec3 ground = from - to_light * (from.y / to_light.y);
        if (std::fabs(ground.x) <= floor.size && std::fabs(ground.z) <= floor.size) return ground;
        return std::nullopt;
      },
      conventions);
}

Raster shadow(const Floor& floor, const SunMap& map, const dvec3& to_light, const std::string& params) {
  return PixelRun(nodes::shade_shadow_map(), params,
                  {{"points", {floor.points()}},
                   {"mesh", {floor.mesh()}},
                   {"lights", {sun(to_light)}},
                   {"maps", {map.depth}},
                   {"cameras", {std::make_shared<const Camera>(map.camera)}}})
      .whole();
}

const Plate plate{-1, 1.5F, -0.5F, 1, 1.25F};
const std::vector<dvec3> lights{{1, 2, 0.5}, {0, 1, 0}, {4, 1, 1}, {-1.5, 0.3, 0.7}};

// How far a texel reaches on the floor: its diagonal, longer by the slant of the light.
double band(const SunMap& map, const dvec3& to_light) {
  return 1.5 * map.texel * kernels::norm(to_light) / to_light.y;
}

TEST(ShadeShadowMap, AgreesWithTheClosedFormOutsideABandOfATexel) {
  const Floor floor{.size = 4, .edge = 160};
  for (const dvec3& l : lights)
    for (const auto& [size, conventions] : {std::pair{64, Conventions::gl},
                                            {256, Conventions::gl},
                                            {64, Conventions::vulkan},
                                            {64, Conventions::d3d}}) {
      const SunMap map = map_of(floor, plate, l, size, conventions);
      const Raster seen = shadow(floor, map, l, R"({"radius": 0})");
      int near = 0, wrong = 0;
      for (int y = 0; y < floor.edge; ++y)
        for (int x = 0; x < floor.edge; ++x) {
          const double inside = plate.depth_in_shadow(floor.at(x, y), l);
          if (std::fabs(inside) < band(map, l))
            ++near;
          else
            wrong += seen.at<float>(0, 0, x, y) != (inside > 0 ? 0.0F : 1.0F);
        }
      EXPECT_EQ(wrong, 0) << l.x << " " << size;
      EXPECT_LT(near, size == 256 ? 12000 : 25600) << "the band is not the picture";
    }
}

// Acne: without the bias of the slope, or with one constant for all, a slanted light spots the open floor.
TEST(ShadeShadowMap, WithoutBiasTheFloorShadesItself) {
  const Floor floor{.size = 4, .edge = 160};
  const Plate away{9, 9.5F, 9, 9.5F, 1.25F};
  for (const dvec3& l : {dvec3(1, 2, 0.5), dvec3(4, 1, 1)}) {
    const SunMap map = map_of(floor, away, l, 128);
    const auto spots = [&](const std::string& params) {
      const Raster seen = shadow(floor, map, l, params);
      int n = 0;
      for (int y = 0; y < floor.edge; ++y)
        for (int x = 0; x < floor.edge; ++x) n += seen.at<float>(0, 0, x, y) < 1;
      return n;
    };
    EXPECT_GT(spots(R"({"bias": 0, "radius": 0})"), 5000) << l.x;
    EXPECT_GT(spots(R"({"bias": 0.5, "radius": 0})"), 100)
        << l.x << ": the bias is no larger than it must be";
    EXPECT_EQ(spots(R"({"bias": 1, "radius": 0})"), 0) << l.x;
    EXPECT_EQ(spots(R"({"bias": 1, "radius": 3})"), 0) << l.x;
  }
}

// Peter Panning: with a bias in units of the slope the shadow of a plate that almost lies on the floor stays, whatever
// the depth range of the light's camera; a constant that cures acne at the worst slant loses it.
TEST(ShadeShadowMap, AShadowIsNotDetachedFromWhatCastsIt) {
  const Floor floor{.size = 4, .edge = 160};
  const dvec3 steep(0.2, 1, 0.1), slant(4, 1, 1);
  const Plate low{-1, 1.5F, -0.5F, 1, 0.05F};
  const SunMap map = map_of(floor, low, steep, 256), worst = map_of(floor, low, slant, 256);
  const Raster seen = shadow(floor, map, steep, R"({"radius": 0})");
  const kernels::SeenFace ground{dvec3(0), {0, 1, 0}, 0};
  const auto at_worst = shadow_map::seen_from_light(worst.view, ground, dvec3(0)).value();
  // World units: what cures acne under the slanted light.
  const double constant = 0.5 * (at_worst.z_by_x_px + at_worst.z_by_y_px) / at_worst.z_by_distance;
  int inside = 0, lost = 0;
  for (int y = 0; y < floor.edge; ++y)
    for (int x = 0; x < floor.edge; ++x) {
      const dvec3 p = floor.at(x, y);
      if (low.depth_in_shadow(p, steep) < band(map, steep)) continue;
      ++inside;
      EXPECT_EQ(seen.at<float>(0, 0, x, y), 0.0F);
      const auto s = shadow_map::seen_from_light(map.view, ground, p).value();
      const auto z = [&](int i, int j) {
        return static_cast<double>(map.depth->raster.at<float>(0, 0, i, j));
      };
      lost += shadow_map::share_of_light(s, constant * s.z_by_distance, 0, map.camera.resolution,
                                         kernels::DepthRange::minus_one_to_one, z) > 0;
    }
  EXPECT_GT(inside, 1000);
  EXPECT_EQ(lost, inside) << "the constant form fails here";
}

TEST(ShadeShadowMap, TheShareOfTexelsFallsFromOneToZeroOverTheBlur) {
  const Floor floor{.size = 4, .edge = 160};
  const SunMap map = map_of(floor, plate, {0, 1, 0}, 128);
  const Raster seen = shadow(floor, map, {0, 1, 0}, R"({"radius": 2})");
  std::set<float> shares;
  float last = 1;
  for (int x = 20; x < 80; ++x) {
    const float v = seen.at<float>(0, 0, x, 85);
    EXPECT_LE(v, last);
    shares.insert(last = v);
  }
  EXPECT_EQ(last, 0.0F);
  EXPECT_EQ(shares.size(), 6u) << "five columns of texels come in one after the other";
}

TEST(ShadeShadowMap, KeepsTheLawOfTiles) {
  const Floor floor{.size = 4, .edge = 43};
  const SunMap map = map_of(floor, plate, lights[0], 64);
  EXPECT_EQ(test::break_of_tile_law(PixelRun(nodes::shade_shadow_map(), "{}",
                                             {{"points", {floor.points()}},
                                              {"mesh", {floor.mesh()}},
                                              {"lights", {sun(lights[0])}},
                                              {"maps", {map.depth}},
                                              {"cameras", {std::make_shared<const Camera>(map.camera)}}})),
            "");
}

TEST(ShadeShadowMap, DepthRatesAreThoseOfThePlane) {
  const light_camera::View v = light_camera::view_from(
      {1, 5, 2}, kernels::normalized(dvec3(-0.2, -1, 0.1)).value(), {0, 0, 1}, 0.7, {}, 100);
  const kernels::SeenFace face{dvec3(0, 0.3, 0), kernels::normalized(dvec3(0.3, 1, -0.4)).value(), 0};
  for (const kernels::ClipSpace space : test::clip_spaces) {
    const shadow_map::View view{kernels::look_at(v.eye, v.target, v.up).eye_from_world,
                                kernels::perspective(v.fov_y, 1, 0.5, 20, space),
                                kernels::Viewport({100, 100}, space.y_down)};
    const auto on_plane = [&](double x, double z) {
      return dvec3(x, 0.3 - (face.normal.x * x + face.normal.z * z) / face.normal.y, z);
    };
    const auto a = shadow_map::seen_from_light(view, face, on_plane(0.4, 0.1)).value();
    const auto b = shadow_map::seen_from_light(view, face, on_plane(0.9, 0.2)).value();
    const auto c = shadow_map::seen_from_light(view, face, on_plane(0.5, 0.8)).value();
    // z = z_a + g . (px - px_a), solved from three points.
    const double x1 = b.x_px - a.x_px, y1 = b.y_px - a.y_px, x2 = c.x_px - a.x_px, y2 = c.y_px - a.y_px;
    const double det = x1 * y2 - x2 * y1;
    EXPECT_NEAR(std::fabs(((b.z - a.z) * y2 - (c.z - a.z) * y1) / det), a.z_by_x_px, 1e-12);
    EXPECT_NEAR(std::fabs(((c.z - a.z) * x1 - (b.z - a.z) * x2) / det), a.z_by_y_px, 1e-12);
  }
}

std::string refusal(const test::NodeInputs& in) {
  try {
    PixelRun(nodes::shade_shadow_map(), "{}", in);
  } catch (const NodeError& e) {
    return e.code + " " + e.part;
  }
  return "none";
}

TEST(ShadeShadowMap, WhatDoesNotFitIsRefused) {
  const Floor floor{.size = 4, .edge = 8};
  const SunMap map = map_of(floor, plate, lights[0], 16);
  const Buffer camera = std::make_shared<const Camera>(map.camera);
  test::NodeInputs in{{"points", {floor.points()}}, {"mesh", {floor.mesh()}}, {"lights", {sun(lights[0])}}};
  in["maps"] = {map.depth}, in["cameras"] = {camera};
  EXPECT_EQ(refusal(in), "none");
  in["cameras"] = {};
  EXPECT_EQ(refusal(in), "wrong_maps /in/cameras");
  in["maps"] = {map.depth, map.depth};
  EXPECT_EQ(refusal(in), "wrong_maps /in/maps");
  in["lights"] = {one_light({.kind = Light::Kind::point, .position = {0, 3, 0}})};
  EXPECT_EQ(refusal(in), "wrong_maps /in/maps") << "a point light has six";
  in["lights"] = {one_light({.kind = Light::Kind::area, .edge_u = {1, 0, 0}, .edge_v = {0, 0, 1}})};
  EXPECT_EQ(refusal(in), "area_light /in/lights");
  in["lights"] = {sun(lights[0])};
  in["maps"] = {map.depth}, in["cameras"] = {std::make_shared<const Camera>()};
  EXPECT_EQ(refusal(in), "different_frames /in/maps/0");
}

}  // namespace
}  // namespace frustum
