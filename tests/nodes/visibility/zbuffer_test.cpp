#include "nodes/visibility/zbuffer.h"

#include <gtest/gtest.h>

#include "tests/hard/exact.h"
#include "tests/nodes/visibility/scenes.h"

namespace frustum {
namespace {

using zbuffer::Format;
using zbuffer::kept;

TEST(VisibilityZbuffer, WithRealsHasTheBytesOfRasterizeTriangles) {
  for (const int tile : {0, 7}) {
    const auto show = [&](const Buffer& mesh, const Buffer& pattern, Precision precision) {
      return test::shown(nodes::visibility_zbuffer(), {{mesh}, {pattern}}, precision, tile,
                         {{"format", "real"}});
    };
    test::expect_depth_buffer<float>(Precision::single, 3, show);
    test::expect_depth_buffer<double>(Precision::real_double, 3, show);
  }
}

// Hard case ZBF-10: monotone, 1 stays 1, nothing wraps.
TEST(VisibilityZbuffer, KeepsOrderAndEndsInEveryFormat) {
  test::Random random(46);
  for (const Format format : {Format::unorm16, Format::unorm24, Format::unorm32, Format::float32})
    for (const double low : {-1.0, 0.0}) {
      EXPECT_EQ(kept(format, 1, low), 1);
      EXPECT_EQ(kept(format, low, low), low);
      EXPECT_EQ(kept(format, std::nextafter(1.0, 0.0), low), 1);
      if (format != Format::float32) {
        EXPECT_EQ(kept(format, std::nextafter(1.0, 2.0), low), 1);
        EXPECT_EQ(kept(format, NAN, low), low);
      }
      for (int i = 0; i < 1000; ++i) {
        const double a = random.uniform(low, 1), b = a + std::exp2(random.uniform(-40, -10));
        ASSERT_LE(kept(format, a, low), kept(format, b, low));
        ASSERT_EQ(kept(format, kept(format, a, low), low), kept(format, a, low));
      }
    }
  EXPECT_EQ(kept(Format::unorm16, 0.25 / 65535, 0), 0);
  EXPECT_EQ(kept(Format::unorm16, 0.75 / 65535, 0), 1.0 / 65535);
}

// Row 41: depth after the divide is linear on the screen, so both ways give the same but for rounding.
TEST(VisibilityZbuffer, PlaneAndEdgesAgreeWithinRounding) {
  test::Random random(47);
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const double u = precision == Precision::single ? 0x1p-24 : 0x1p-53;
    const auto m = test::soup<double>(random, test::Soup::any, 40);
    test::ScreenMeshMaker<double> gentle = m;  // slopes of less than 2 a face's extent
    for (auto& p : gentle.position) p.z *= 0.25;
    const Buffer mesh = precision == Precision::single ? test::buffer_of([&] {
      test::ScreenMeshMaker<float> f;
      for (const auto& p : gentle.position) f.vertex(p.x, p.y, p.z);
      f.face = gentle.face;
      return f.make(test::scene_size);
    }())
                                                       : test::buffer_of(gentle.make(test::scene_size));
    const auto shown = [&](const char* how) {
      return test::shown(nodes::visibility_zbuffer(), {{mesh}, {}}, precision, 0,
                         {{"format", "real"}, {"interpolation", how}});
    };
    const Raster plane = shown("plane"), edges = shown("edges");
    int same = 0;
    double worst = 0;
    for (int y = 0; y < test::scene_size.y; ++y)
      for (int x = 0; x < test::scene_size.x; ++x)
        if (plane.at<std::uint32_t>(0, 0, x, y) == edges.at<std::uint32_t>(0, 0, x, y)) {
          ++same;
          worst = std::max(worst, std::fabs(plane.value(1, 0, x, y) - edges.value(1, 0, x, y)));
        }
    EXPECT_GT(same, test::scene_size.x * test::scene_size.y * 99 / 100);
    // Slivers amplify rounding by their aspect: some 2^12 of 96 px over 2^-6 px.
    EXPECT_LT(worst, u * 0x1p14);
    EXPECT_GT(worst, 0);
  }
}

// Two walls 0.2 % apart at the far end of a room from 0.001 to 1000: 24 bits make one of them, 32 do not.
TEST(VisibilityZbuffer, FewBitsCannotTellFarWallsApart) {
  const auto depth = [](double w) { return (1000.001 - 2 * 0.001 * 1000 / w) / 999.999; };
  test::ScreenMeshMaker<double> m;
  for (const double w : {501.0, 500.0}) {
    const auto a = m.vertex(0, 0, depth(w)), b = m.vertex(180, 0, depth(w)), c = m.vertex(0, 130, depth(w));
    m.face.emplace_back(a, b, c);
  }
  const Buffer mesh = test::buffer_of(m.make(test::scene_size));
  const auto seen = [&](const char* format) {
    return test::shown(nodes::visibility_zbuffer(), {{mesh}, {}}, Precision::real_double, 0,
                       {{"format", format}})
        .at<std::uint32_t>(0, 0, 5, 5);
  };
  EXPECT_EQ(seen("unorm16"), 0U);  // a tie, which the farther wall wins as the lower source
  EXPECT_EQ(seen("unorm24"), 0U);
  EXPECT_EQ(seen("unorm32"), 1U);
  EXPECT_EQ(seen("real"), 1U);
}

// ----- depth bias

using hard::Rational;

Rational power_of_two(int e) {
  return e < 0 ? Rational(1) / Rational(std::ldexp(1.0, -e)) : Rational(std::ldexp(1.0, e));
}

// What the specifications say of a face whose window depth has the slopes a and b, in rationals: o = slope m + constant r.
struct BiasCase {
  Conventions conventions;
  bool reversed_z;
  const char* format;
  double constant, slope, clamp;

  bool whole_numbers() const { return std::string_view(format).starts_with("unorm"); }
  int bits() const { return std::stoi(std::string(format).substr(5)); }
  int range() const { return conventions == Conventions::gl && !reversed_z ? 2 : 1; }  // of NDC depth
  // `e`: 2^e <= |z| < 2^(e + 1) for the greatest depth of NDC.
  Rational offset(const Rational& m, int e, int digits) const {
    const Rational r = whole_numbers() ? power_of_two(-bits()) : Rational(power_of_two(e - digits) / range());
    const Rational o = Rational(slope) * m + Rational(constant) * r, bound(clamp);
    return clamp > 0 && o > bound ? bound : clamp < 0 && o < bound ? bound : o;
  }
};

template <class R>
Raster biased(const BiasCase& c, const test::ScreenMeshMaker<R>& m, const Json& names = Json::array(),
              const std::shared_ptr<const MaterialSet>& materials = {}) {
  auto mesh = m.make(test::scene_size);
  auto camera = std::make_shared<Camera>(*mesh->camera);
  camera->conventions = c.conventions, camera->reversed_z = c.reversed_z;
  mesh->camera = camera;
  if (materials) {
    mesh->materials = materials;
    std::vector<std::uint32_t> of;
    for (std::uint32_t f = 0; f < m.face.size(); ++f) of.push_back(f % 2);
    mesh->columns.push_back(Column::make<std::uint32_t>("material", Domain::face, of));
  }
  return test::shown(nodes::visibility_zbuffer(), {{test::buffer_of(std::move(mesh))}, {}},
                     sizeof(R) == 4 ? Precision::single : Precision::real_double, 0,
                     {{"format", c.format},
                      {"bias_constant", c.constant},
                      {"bias_slope", c.slope},
                      {"bias_clamp", c.clamp},
                      {"bias_materials", names}});
}

// Slopes of 2^-9 and -2^-8 per px of NDC depth between 1/4 and 1/2 or so: every number is exact.
template <class R>
void expect_offset(const BiasCase& c) {
  test::ScreenMeshMaker<R> m;
  m.vertex(0, 0, 0.375), m.vertex(16, 0, 0.375 + 0x1p-5), m.vertex(0, 16, 0.375 - 0x1p-4);
  m.face.emplace_back(0, 1, 2);
  const Raster got = biased<R>(c, m);
  const int range = c.range();
  const Rational low = c.range() == 2 ? -1 : 0;
  const bool single = sizeof(R) == 4 || std::string_view(c.format) == "float32";
  const Rational o = c.offset(power_of_two(-8) / range, -2, single ? 23 : 52) * range;
  for (const glm::ivec2 p : {glm::ivec2(1, 1), {9, 2}, {3, 10}}) {
    Rational z =
        Rational(0.375) + Rational(p.x + 0.5) * power_of_two(-9) - Rational(p.y + 0.5) * power_of_two(-8) + o;
    if (z > 1) z = 1;
    if (z < low) z = low;
    if (c.whole_numbers()) {
      const Rational steps = power_of_two(c.bits()) - 1, at = (z - low) / range * steps + Rational(0.5);
      z = low + range * Rational(mpz_class(at.get_num() / at.get_den())) / steps;
    }
    const double u = single ? 0x1p-24 : 0x1p-53;
    EXPECT_NEAR(got.value(1, 0, p.x, p.y), z.get_d(), u * (c.whole_numbers() ? 4 : 0.5))
        << c.format << ' ' << c.slope;
  }
}

TEST(DepthBias, IsThatOfTheSpecificationsInRationals) {
  for (const Conventions conventions : {Conventions::gl, Conventions::vulkan, Conventions::d3d})
    for (const bool reversed : {false, true})
      for (const char* format : {"unorm16", "unorm24", "unorm32", "float32", "real"})
        for (const auto [constant, slope, clamp] : {std::array{0.0, 0.0, 0.0},
                                                    {8, 0, 0},
                                                    {-5, 0, 0},
                                                    {0, 3, 0},
                                                    {64, -2.5, 0},
                                                    {0, 3, 0x1p-8},
                                                    {0, -3, -0x1p-8},
                                                    {0, 3, -0x1p-8},
                                                    {0, 1000, 0},
                                                    {0, -1000, 0}}) {
          const BiasCase c{conventions, reversed, format, constant, slope, clamp};
          expect_offset<double>(c);
          expect_offset<float>(c);
        }
}

TEST(DepthBias, CountsTheBinadeOfTheGreatestDepth) {
  using zbuffer::least_difference;
  EXPECT_EQ(least_difference(Format::unorm16, 0.3, 23, 2), 0x1p-16);
  EXPECT_EQ(least_difference(Format::unorm24, 0.3, 52, 1), 0x1p-24);
  EXPECT_EQ(least_difference(Format::float32, 1, 23, 1), 0x1p-23);
  EXPECT_EQ(least_difference(Format::float32, std::nextafter(1.0F, 0.0F), 52, 1), 0x1p-24);
  EXPECT_EQ(least_difference(Format::float32, 0.25, 23, 2), 0x1p-26);
  EXPECT_EQ(least_difference(Format::real, 0.5, 52, 1), 0x1p-53);
  EXPECT_EQ(least_difference(Format::real, 0, 23, 1), 0x1p-149);
  EXPECT_EQ(least_difference(Format::real, 0, 52, 1), 0x1p-1074);
}

// Without a bias nothing changes, bit for bit; a step of the format moves reals by one step at least.
TEST(DepthBias, OfNothingChangesNothingAndOfOneStepEverything) {
  test::Random random(48);
  const auto m = test::soup<float>(random, test::Soup::any, 40);
  const BiasCase none{Conventions::vulkan, false, "real", 0, 0, 0.5},
      one{Conventions::vulkan, false, "real", 1, 0, 0};
  test::ScreenMeshMaker<float> shifted = m;
  for (auto& p : shifted.position) p.z = p.z * 0.25F + 0.5F;
  const Raster plain =
      test::shown(nodes::visibility_zbuffer(), {{test::buffer_of(shifted.make(test::scene_size))}, {}},
                  Precision::single, 0, {{"format", "real"}});
  EXPECT_EQ(test::differences(plain, biased(none, shifted)), 0);
  const Raster moved = biased(one, shifted);
  for (int y = 0; y < test::scene_size.y; ++y)
    for (int x = 0; x < test::scene_size.x; ++x)
      if (plain.at<std::uint32_t>(0, 0, x, y) != no_face &&
          plain.at<std::uint32_t>(0, 0, x, y) == moved.at<std::uint32_t>(0, 0, x, y)) {
        EXPECT_GT(moved.value(1, 0, x, y), plain.value(1, 0, x, y));
      }
}

// A decal in the plane of its wall, of other triangles: their depths round differently, and without a bias they fight.
template <class R>
void expect_decal(const char* format, bool reversed) {
  test::ScreenMeshMaker<R> m;
  const auto z = [](double x, double y) { return 0.3 + 0.0041 * x + 0.0023 * y; };
  const auto add = [&](std::array<glm::dvec2, 3> p) {
    glm::uvec3 f;
    for (std::size_t k = 0; k < 3; ++k)
      f[static_cast<glm::length_t>(k)] = m.vertex(p[k].x, p[k].y, z(p[k].x, p[k].y));
    m.face.push_back(f);
  };
  add({{{-3, -5}, {150, 1}, {2, 120}}}), add({{{7.125, 5.25}, {60.75, 11.875}, {13.25, 50.25}}});
  const auto names = std::make_shared<const MaterialSet>(MaterialSet{{{.name = "wall"}, {.name = "decal"}}});
  const double nearer = reversed ? 1 : -1;
  const auto decals = [&](double steps, double slope, const Json& of) {
    const Raster seen =
        biased<R>({Conventions::gl, reversed, format, nearer * steps, nearer * slope, 0}, m, of, names);
    int n = 0;
    for (int y = 0; y < test::scene_size.y; ++y)
      for (int x = 0; x < test::scene_size.x; ++x) n += seen.at<std::uint32_t>(0, 0, x, y) == 1U ? 1 : 0;
    return n;
  };
  const int all = decals(1e5, 100, {"decal"});
  EXPECT_GT(all, 1000);
  EXPECT_LT(decals(0, 0, Json::array()), all);  // the lower source wins ties, rounding the rest
  EXPECT_EQ(decals(2, 1, {"decal"}), all);
  EXPECT_EQ(decals(-2, -1, {"decal"}), 0);
  EXPECT_EQ(decals(2, 1, {"wall"}), 0);
  EXPECT_LT(decals(2, 1, {"decal", "wall"}), all);  // both move alike
}
TEST(DepthBias, LetsADecalWin) {
  for (const bool reversed : {false, true})
    for (const char* format : {"unorm16", "unorm24", "float32", "real"}) {
      expect_decal<float>(format, reversed);
      expect_decal<double>(format, reversed);
    }
}

TEST(DepthBias, RefusesAMaterialThatIsNotThere) {
  test::ScreenMeshMaker<float> m;
  m.vertex(0, 0), m.vertex(9, 0), m.vertex(0, 9);
  m.face.emplace_back(0, 1, 2);
  EXPECT_EQ(test::run_error(nodes::visibility_zbuffer(), {{"bias_materials", {"decal"}}},
                            {{test::buffer_of(m.make(test::scene_size))}, {}})
                .first,
            "unknown_material");
}

}  // namespace
}  // namespace frustum
