// shade.surface: closed forms of Lambert, Phong and Blinn, the three interpolations, and the vector kernels.
#include "nodes/all_nodes.h"
#include "nodes/kernels/lighting.h"
#include "nodes/kernels/simd/lighting.h"
#include "nodes/kernels/vector.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/light.h"
#include "runtime/buffers/mesh.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <set>

namespace frustum {
namespace {

using kernels::Highlight;
using kernels::Triple;

// ----- the kernels

kernels::LightSetup<double> one_light(const kernels::LightSource<double>& light, Highlight h, double e) {
  return {{&light, 1}, {0, 0, 10}, h, kernels::Exponent<double>(e)};
}

const kernels::LightSource<double> head_light{false, {1, 1, 1}, {0, 0, 1}, {}};

TEST(Lighting, AHeadLitSphereHasAMeanOfTwoThirdsOverItsDisc) {
  const auto setup = one_light(head_light, Highlight::none, 1);
  double sum = 0, count = 0;
  const int n = 1000;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = (2 * i + 1.0) / n - 1, y = (2 * j + 1.0) / n - 1, zz = 1 - x * x - y * y;
      if (zz < 0) continue;
      sum += kernels::receive(setup, {3 * x, 3 * y, 3 * std::sqrt(zz)}, {x, y, std::sqrt(zz)})
                 .diffuse[0];  // any length
      ++count;
    }
  EXPECT_NEAR(sum / count, 2.0 / 3,
              1e-4);  // 2 pi n / 2 pixels of the rim count wholly or not: some n^-3/2 of the disc
}

TEST(Lighting, PhongPeaksWhereTheEyeIsInTheMirrorDirection) {
  const Triple<double> p{0, 0, 0};
  const kernels::LightSource<double> light{false, {0.5, 1, 2}, {0.6, 0, 0.8}, {}};
  kernels::LightSetup<double> s{{&light, 1}, {-6, 0, 8}, Highlight::phong, kernels::Exponent<double>(60)};
  const auto peak = kernels::receive(s, {0, 0, 1}, p);
  EXPECT_NEAR(peak.specular[0], 0.5, 1e-13);
  EXPECT_NEAR(peak.specular[2], 2, 1e-13);
  EXPECT_NEAR(peak.diffuse[1], 0.8, 1e-15);
  for (const double off : {-0.5, 0.5}) {
    s.eye = {-6 + off, 0, 8};
    EXPECT_LT(kernels::receive(s, {0, 0, 1}, p).specular[1], 0.99);
  }
}

TEST(Lighting, BlinnPeaksWhereTheNormalIsHalfWay) {
  const kernels::LightSource<double> light{false, {1, 1, 1}, {0.6, 0, 0.8}, {}};
  kernels::LightSetup<double> s{{&light, 1}, {0, 0, 10}, Highlight::blinn, kernels::Exponent<double>(200)};
  const Triple<double> h = kernels::unit3<double>({0.6, 0, 1.8});
  EXPECT_NEAR(kernels::receive(s, h, {0, 0, 0}).specular[0], 1, 1e-13);
  // H.V, the printed form (errata E35), would not fall when the normal turns away from H.
  EXPECT_LT(kernels::receive(s, {0, 0.3, 1}, {0, 0, 0}).specular[0], 0.2);
}

TEST(Lighting, TheIntegralOfThePhongLobeIsItsClosedForm) {
  // Over the hemisphere around r = n (light along n): integral of cos^e = 2 pi / (e + 1).
  for (const double e : {1.0, 8.0, 60.0, 33.5}) {
    kernels::LightSetup<double> s{{&head_light, 1}, {}, Highlight::phong, kernels::Exponent<double>(e)};
    double sum = 0;
    const int n = 4000;
    for (int i = 0; i < n; ++i) {
      const double z = (i + 0.5) / n, r = std::sqrt(1 - z * z);
      s.eye = {r, 0, z};
      sum += kernels::receive(s, {0, 0, 1}, {0, 0, 0}).specular[0] / n;
    }
    EXPECT_NEAR(sum * (e + 1), 1, 1e-4) << e;  // midpoint rule: (e + 1) e / (24 n^2)
  }
}

TEST(Lighting, NothingIsLitFromBehindAndNothingIsEverNegative) {
  test::Random random(3);
  for (const Highlight h : {Highlight::none, Highlight::phong, Highlight::blinn})
    for (int i = 0; i < 5000; ++i) {
      const auto v = [&] {
        return Triple<double>{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      };
      const Triple<double> l = kernels::unit3(v()), n = v();
      const kernels::LightSource<double> light{false, {1, 1, 1}, l, {}};
      kernels::LightSetup<double> s{{&light, 1}, v(), h, kernels::Exponent<double>(random.uniform(0, 90))};
      const auto r = kernels::receive(s, n, v());
      const bool behind = kernels::dot3(n, l) <= 0;
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_GE(r.diffuse[k], 0);
        EXPECT_GE(r.specular[k], 0);
        EXPECT_LE(r.specular[k], 1);
        if (behind) {
          EXPECT_EQ(r.diffuse[k] + r.specular[k], 0);
        }
      }
    }
}

TEST(Lighting, ChannelsDoNotMix) {
  for (std::size_t k = 0; k < 3; ++k) {
    kernels::LightSource<double> light = head_light;
    light.color = {0.3, 0.6, 0.9};
    const auto all = kernels::receive(one_light(light, Highlight::blinn, 20), {0.2, 0.1, 1}, {0, 0, 0});
    light.color[k] = 0;
    const auto less = kernels::receive(one_light(light, Highlight::blinn, 20), {0.2, 0.1, 1}, {0, 0, 0});
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(less.diffuse[c], c == k ? 0 : all.diffuse[c]);
  }
}

TEST(Lighting, PointLightsFallOffWithTheSquareOfDistance) {
  const kernels::LightSource<double> light{true, {12, 12, 12}, {0, 0, 2}, {0, 0, 1}};
  const auto s = one_light(light, Highlight::none, 1);
  EXPECT_DOUBLE_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, 0}).diffuse[0], 3);
  EXPECT_DOUBLE_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, -2}).diffuse[0], 0.75);
  EXPECT_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, 2}).diffuse[0], 0) << "on the light itself";
}

TEST(Lighting, DegenerateVectorsGiveNoLightAndNoNan) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  for (const Highlight h : {Highlight::phong, Highlight::blinn})
    for (const Triple<double>& n : {Triple<double>{0, 0, 0}, {nan, 0, 1}, {inf, 0, 1}, {1e-200, 0, 0}}) {
      const auto r = kernels::receive(one_light(head_light, h, 5), n, {0, 0, 0});
      EXPECT_EQ(r.diffuse[0] + r.specular[0], 0);
    }
  // The eye opposite to the light: h has no length.
  kernels::LightSetup<double> s{{&head_light, 1}, {0, 0, -5}, Highlight::blinn, kernels::Exponent<double>(5)};
  EXPECT_EQ(kernels::receive(s, {0, 0, 1}, {0, 0, 0}).specular[0], 0);
}

TEST(Lighting, PowersBySquaringMeetTheirBound) {
  for (const double e : {0.0, 1.0, 2.0, 60.0, 1023.0, 1024.0})
    for (const float x : {0.0F, 0.5F, 0.99F, 0.9999F, 1.0F}) {
      const double exact = std::pow(static_cast<double>(x), e);
      EXPECT_NEAR(kernels::Exponent<float>(e)(x), exact, exact * (e + 1) * 0x1p-23 + 0x1p-149)
          << x << "^" << e;
    }
  EXPECT_EQ(kernels::Exponent<float>(0.5).whole, -1);
  EXPECT_EQ(kernels::Exponent<float>(0.5)(0.25F), 0.5F);
  EXPECT_EQ(kernels::Exponent<float>(1e5)(0.9F), 0);
}

struct RandomRows {
  std::vector<std::vector<float>> row;
  std::vector<std::uint32_t> tag;
  RandomRows(std::size_t rows, std::size_t n, unsigned seed) {
    test::Random random(seed);
    constexpr float odd[] = {0,
                             -0.0F,
                             1e-30F,
                             1e30F,
                             std::numeric_limits<float>::infinity(),
                             std::numeric_limits<float>::quiet_NaN()};
    for (std::size_t r = 0; r < rows; ++r) {
      auto& v = row.emplace_back();
      for (std::size_t i = 0; i < n; ++i)
        v.push_back(random.below(40) == 0 ? odd[random.below(6)] : static_cast<float>(random.uniform(-2, 2)));
    }
    for (std::size_t i = 0; i < n; ++i)
      tag.push_back(random.below(6) == 0 ? no_face : static_cast<std::uint32_t>(random.below(3)));
  }
  std::array<const float*, 3> three(std::size_t at) const {
    return {row[at].data(), row[at + 1].data(), row[at + 2].data()};
  }
};

std::string difference(const std::vector<float>& a, const std::vector<float>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::bit_cast<std::uint32_t>(a[i]) != std::bit_cast<std::uint32_t>(b[i]))
      return "element " + std::to_string(i) + ": " + std::to_string(a[i]) + ", not " + std::to_string(b[i]);
  return "";
}

TEST(LightingSimd, EveryTargetHasTheBitsOfTheScalarTwin) {
  constexpr std::size_t n = 517;
  const RandomRows in(10, n, 9);
  const kernels::LightSource<float> lights[] = {{false, {1, 0.5F, 0.2F}, {0.6F, 0, 0.8F}, {}},
                                                {true, {3, 2, 1}, {0.5F, 1, 2}, {0.1F, 0.2F, 1}},
                                                {true, {1, 1, 1}, {-1, 0, 0}, {0, 0, 1}}};
  for (const Highlight h : {Highlight::none, Highlight::phong, Highlight::blinn})
    for (const double e : {0.0, 1.0, 60.0, 33.3})
      for (const std::uint32_t wanted : {kernels::nothing_there, 1u})
        for (const bool turned : {false, true}) {
          const kernels::LightSetup<float> setup{lights, {1, 2, 3}, h, kernels::Exponent<float>(e)};
          const kernels::PointRows<float> points{in.three(0), in.three(3),
                                                 turned ? in.row[6].data() : nullptr};
          const kernels::Selection which{in.tag.data(), wanted};
          std::vector<std::vector<float>> truth(10, std::vector<float>(n, 7)), simd = truth;
          const auto run = [&](auto receive, auto reflect, std::vector<std::vector<float>>& out) {
            const kernels::LightRows<float> light{{out[0].data(), out[1].data(), out[2].data()},
                                                  {out[3].data(), out[4].data(), out[5].data()}};
            receive(setup, points, which, n, light);
            for (std::size_t x = 0; x < n; ++x)
              if (!which.has(x))
                for (std::size_t k = 0; k < 6; ++k) out[k][x] = 0;
            const kernels::SurfaceColors<float> colors{
                {0.1F, 0.2F, 0.3F}, {1, 0.5F, 0.25F}, {0.4F, 0.4F, 0.4F}};
            reflect(colors, light, turned ? std::array<const float*, 3>{} : in.three(7), which, turned, n,
                    kernels::ColorRows<float>{{out[6].data(), out[7].data(), out[8].data(), out[9].data()}});
          };
          run([](auto&&... a) { kernels::receive_light<float>(a...); },
              [](auto&&... a) { kernels::reflect_light<float>(a...); }, truth);
          test::for_each_simd_target([&](const char* target) {
            run([](auto&&... a) { kernels::simd::receive_light(a...); },
                [](auto&&... a) { kernels::simd::reflect_light(a...); }, simd);
            for (std::size_t k = 0; k < 10; ++k)
              ASSERT_EQ(difference(simd[k], truth[k]), "") << target << " row " << k;
          });
        }
}

TEST(LightingSimd, FacesAreTakenAlikeOnEveryTarget) {
  constexpr std::size_t n = 77, samples = 8, planes = 5;
  test::Random random(4);
  std::vector<std::uint32_t> ids(samples * n);
  for (auto& id : ids) id = random.below(4) == 0 ? no_face : static_cast<std::uint32_t>(random.below(3));
  const RandomRows in(samples * planes, n, 5);
  std::vector<const float*> rows;
  for (const auto& r : in.row) rows.push_back(r.data());
  using Taken = std::vector<std::pair<std::vector<std::uint32_t>, std::vector<std::vector<float>>>>;
  const auto all_of = [&](auto take) {
    Taken all;
    auto left = ids;
    std::vector<std::uint32_t> face(n);
    for (;;) {
      std::vector<std::vector<float>> mean(planes, std::vector<float>(n, 0));
      std::vector<float*> to;
      for (auto& m : mean) to.push_back(m.data());
      if (!take(left.data(), rows, face.data(), to)) break;
      for (std::size_t x = 0; x < n; ++x)
        if (face[x] == no_face)
          for (auto& m : mean) m[x] = 0;
      all.emplace_back(face, mean);
    }
    return all;
  };
  const Taken truth = all_of([&](auto* left, auto& from, auto* face, auto& to) {
    return kernels::take_face<float>(left, samples, n, 0, n, from, face, to);
  });
  EXPECT_EQ(truth.size(), 3u);
  test::for_each_simd_target([&](const char* target) {
    const Taken simd = all_of([&](auto* left, auto& from, auto* face, auto& to) {
      return kernels::simd::take_face(left, samples, n, from, face, to);
    });
    ASSERT_EQ(simd.size(), truth.size()) << target;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_EQ(simd[i].first, truth[i].first) << target;
      for (std::size_t p = 0; p < planes; ++p)
        EXPECT_EQ(difference(simd[i].second[p], truth[i].second[p]), "") << target;
    }
  });
}

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
  return std::make_shared<const Light>(Light{.kind = Light::Kind::directional, .direction = direction});
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
  const Buffer ambient =
      std::make_shared<const Light>(Light{.kind = Light::Kind::ambient, .color = {0.25, 0.5, 0}});
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
