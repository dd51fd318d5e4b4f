// texture.sample: pyramids and checkerboards against closed forms, and the vector kernels against their
// scalar twins.
#include "nodes/kernels/half.h"
#include "nodes/kernels/simd/texture_lookup.h"
#include "nodes/texture.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/texture.h"
#include "tests/support/tiles.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace frustum {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();

// Texels that are all different; every level its own.
MipPyramid random_pyramid(int width, int height, Wrap u, Wrap v) {
  test::Random random(7);
  MipPyramid p{.levels = {}, .wrap_u = u, .wrap_v = v};
  for (int w = width, h = height;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
    MipPyramid::Level level{w, h, {}};
    for (int i = 0; i < w * h * 4; ++i)
      level.rgba.push_back(static_cast<float>(random.below(1 << 20)) / (1 << 20));
    p.levels.push_back(std::move(level));
    if (w == 1 && h == 1) return p;
  }
}

std::vector<kernels::TexelLevel> levels_of(const MipPyramid& p) {
  std::vector<kernels::TexelLevel> levels;
  for (const auto& l : p.levels)
    levels.push_back({l.width, l.height, l.rgba.empty() ? nullptr : l.rgba.data(), l.half_rgba.data()});
  return levels;
}

// The same numbers twice: in 16 bits, and what these stand for in 32.
std::pair<MipPyramid, MipPyramid> in_half_and_rounded(const MipPyramid& p) {
  MipPyramid half = p, rounded = p;
  for (std::size_t l = 0; l < p.levels.size(); ++l) {
    half.levels[l].rgba.clear();
    for (float& n : rounded.levels[l].rgba) {
      half.levels[l].half_rgba.push_back(kernels::to_half(n));
      n = kernels::from_half(half.levels[l].half_rgba.back());
    }
  }
  return {half, rounded};
}

struct Points {
  std::vector<float> u, v, du_dx, dv_dx, du_dy, dv_dy;
  std::vector<std::uint32_t> id;
  void add(float a, float b, float scale, std::uint32_t face = 0) {
    u.push_back(a), v.push_back(b), id.push_back(face);
    du_dx.push_back(scale), dv_dx.push_back(-0.3F * scale), du_dy.push_back(0.2F * scale),
        dv_dy.push_back(0.9F * scale);
  }
  kernels::UvRows<float> rows() const {
    return {u.data(), v.data(), du_dx.data(), dv_dx.data(), du_dy.data(), dv_dy.data(), id.data()};
  }
};

Points hostile_points() {
  Points p;
  test::Random random(5);
  const auto real = [&] { return static_cast<float>(random.below(1 << 22)) / (1 << 20) - 2.0F; };
  for (int i = 0; i < 1003; ++i)
    p.add(real(), real(), std::ldexp(1.0F + real() * 0.1F, -static_cast<int>(random.below(14))),
          random.below(5) == 0 ? no_face : 1u);
  for (const float u : {0.0F, -0.0F, 1.0F, -1e-30F, 1e-40F, 0.5F, 16777217.0F, 1e30F, -1e30F, inf, -inf, nan})
    for (const float v : {0.0F, 1.0F, nan, inf, -3.5F})
      for (const float s : {0.0F, 1e-40F, 1e-3F, 1.0F, 1e20F, inf, nan}) p.add(u, v, s);
  return p;
}

template <class Source>
void expect_twins(const Source& source, const Points& p, kernels::Lookup filter) {
  const std::size_t n = p.u.size();
  std::vector<float> truth[4], simd[4];
  kernels::RgbaRows<float> to_truth, to_simd;
  for (std::size_t k = 0; k < 4; ++k) {
    truth[k].assign(n, -1), simd[k].assign(n, -2);
    to_truth.plane[k] = truth[k].data(), to_simd.plane[k] = simd[k].data();
  }
  kernels::look_up(source, filter, p.rows(), n, to_truth);
  test::for_each_simd_target([&](const char* target) {
    kernels::simd::look_up(source, filter, p.rows(), n, to_simd);
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < n; ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(truth[k][i]), std::bit_cast<std::uint32_t>(simd[k][i]))
            << target << " channel " << k << " u " << p.u[i] << " v " << p.v[i] << " du " << p.du_dx[i]
            << " gives " << simd[k][i] << ", not " << truth[k][i];
  });
}

TEST(TextureLookup, EveryTargetHasTheBitsOfTheScalarTwin) {
  const Points p = hostile_points();
  for (const auto filter : {kernels::Lookup::nearest, kernels::Lookup::bilinear, kernels::Lookup::trilinear,
                            kernels::Lookup::mitchell, kernels::Lookup::ewa}) {
    expect_twins(kernels::CheckerColors<float>{12, {0.7F, 0.3F, 0.2F}, {0.1F, 0, 0.9F}}, p, filter);
    for (const Wrap u : {Wrap::repeat, Wrap::clamp, Wrap::mirror, Wrap::border})
      for (const Wrap v : {Wrap::repeat, Wrap::clamp, Wrap::mirror}) {
        const MipPyramid pyramid = random_pyramid(37, 16, u, v);
        for (const MipPyramid& stored : {pyramid, in_half_and_rounded(pyramid).first}) {
          const auto levels = levels_of(stored);
          expect_twins(kernels::TexelPyramid{levels, static_cast<kernels::EdgeRule>(u),
                                             static_cast<kernels::EdgeRule>(v)},
                       p, filter);
        }
      }
  }
}

TEST(TextureLookup, NumbersOf16BitsAreReadAsTheNumbersTheyStandFor) {
  const Points p = hostile_points();
  const auto [half, rounded] = in_half_and_rounded(random_pyramid(37, 16, Wrap::repeat, Wrap::mirror));
  const auto half_levels = levels_of(half), rounded_levels = levels_of(rounded);
  const std::size_t n = p.u.size();
  for (const auto filter : {kernels::Lookup::nearest, kernels::Lookup::bilinear, kernels::Lookup::trilinear,
                            kernels::Lookup::catmull_rom, kernels::Lookup::b_spline, kernels::Lookup::ewa}) {
    std::vector<float> of_half(n), of_rounded(n);
    kernels::RgbaRows<float> to_half, to_rounded;
    to_half.plane[2] = of_half.data(), to_rounded.plane[2] = of_rounded.data();
    kernels::simd::look_up(kernels::TexelPyramid{half_levels}, filter, p.rows(), n, to_half);
    kernels::simd::look_up(kernels::TexelPyramid{rounded_levels}, filter, p.rows(), n, to_rounded);
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_EQ(std::bit_cast<std::uint32_t>(of_half[i]), std::bit_cast<std::uint32_t>(of_rounded[i]))
          << static_cast<int>(filter) << " u " << p.u[i] << " v " << p.v[i];
  }
}

// Nothing is blended beyond the two ends, either end is exact, and equal ends keep their bits.
TEST(TextureLookup, WhatIsBlendedLiesBetweenTheTexels) {
  test::Random random(11);
  const auto real = [&] {
    return std::ldexp(static_cast<float>(random.uniform()) - 0.5F, static_cast<int>(random.below(40)) - 20);
  };
  for (int i = 0; i < 20000; ++i) {
    const float a = real(), b = real();
    const float f = i % 3 == 0 ? 1 - 0x1p-24F : i % 3 == 1 ? 0x1p-20F : static_cast<float>(random.uniform());
    const auto at = [&](float share) {
      return kernels::between(kernels::Rgba<float>{a, b, a, b}, kernels::Rgba<float>{b, a, a, b}, share);
    };
    const auto c = at(f);
    EXPECT_LE(std::min(a, b), c[0]);
    EXPECT_GE(std::max(a, b), c[0]);
    EXPECT_NEAR(c[0], a + f * (static_cast<double>(b) - a),
                std::abs(a - b) * 0x1p-23 + std::max(std::abs(a), std::abs(b)) * 0x1p-23);
    EXPECT_EQ(c[2], a);
    EXPECT_EQ(c[3], b);
    EXPECT_EQ(at(0)[0], a);
    EXPECT_EQ(at(1)[0], b);
  }
}

// The mean of the wave over [a, b], square by square.
double mean_by_squares(double a, double b) {
  double sum = 0;
  for (double k = std::floor(a); k < b; ++k)
    sum += (std::fmod(std::abs(k), 2.0) == 0 ? 1 : -1) * (std::min(b, k + 1) - std::max(a, k));
  return sum / (b - a);
}

TEST(Checkerboard, BoxMeanIsTheSumOverItsSquares) {
  test::Random random(11);
  for (int i = 0; i < 10000; ++i) {
    const double x = (static_cast<double>(random.below(1 << 24)) - (1 << 23)) / (1 << 18);
    const double half = std::ldexp(1.0 + static_cast<double>(random.below(1000)) / 1000,
                                   3 - static_cast<int>(random.below(20)));
    // The oracle adds up to 2 half + 2 pieces, each rounded at the scale of x.
    EXPECT_NEAR(kernels::square_wave_mean(x, half), mean_by_squares(x - half, x + half),
                1e-14 * (1 + std::abs(x) / half));
  }
}

TEST(Checkerboard, ABoxInsideOneSquareHasExactlyItsColour) {
  for (const float x : {0.25F, 1.75F, -0.25F, -1e-6F, 1e-6F, 1000.5F, -999.5F})
    EXPECT_EQ(kernels::square_wave_mean(x, std::abs(x) < 1e-5F ? 1e-7F : 0.2F), kernels::square_wave(x)) << x;
}

TEST(Checkerboard, ABoxOfTwoSquaresIsGrey) {
  for (const float x : {0.0F, 0.3F, -7.9F, 12.5F})
    EXPECT_NEAR(kernels::square_wave_mean(x, 1.0F), 0.0F, 1e-6F);
  EXPECT_EQ(kernels::square_wave_mean(nan, 1.0F), 0.0F);
  EXPECT_EQ(kernels::square_wave_mean(3.0F, inf), 0.0F);
}

// ----- the node

Ref<Image> points_image(Rect window, int samples, float scale, PlaneKind kind = PlaneKind::f32) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = samples;
  pattern->x.assign(static_cast<std::size_t>(samples), 2048), pattern->y = pattern->x;
  Frame f{.window = window, .pattern = pattern, .planes = {{"id", PlaneKind::u32}}};
  for (const char* name : {"uv.u", "uv.v", "uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy"})
    f.planes.push_back({name, kind});
  Raster r(f);
  const auto put = [&](int plane, int s, int x, int y, double v) {
    if (kind == PlaneKind::f64)
      r.view().row<double>(plane, s, y)[x - window.x0] = v;
    else
      r.view().row<float>(plane, s, y)[x - window.x0] = static_cast<float>(v);
  };
  for (int s = 0; s < samples; ++s)
    for (int y = window.y0; y < window.y1; ++y)
      for (int x = window.x0; x < window.x1; ++x) {
        const bool covered = (x + 2 * y + s) % 5 != 0;
        r.view().row<std::uint32_t>(0, s, y)[x - window.x0] = covered ? 3u : no_face;
        if (!covered) continue;
        put(1, s, x, y, 0.013 * x + 0.4), put(2, s, x, y, 0.9 - 0.011 * y + 0.001 * s);
        put(3, s, x, y, scale), put(4, s, x, y, 0.1 * scale), put(5, s, x, y, -0.1 * scale),
            put(6, s, x, y, scale);
      }
  return std::make_shared<Image>(Image{r});
}

Ref<Texture> texture(MipPyramid p) { return std::make_shared<Texture>(Texture{std::move(p)}); }

TEST(TextureSample, KeepsTheLawOfTiles) {
  const auto points = points_image({-3, 5, 61, 40}, 2, 0.02F);
  for (const auto& t : {texture(random_pyramid(32, 20, Wrap::repeat, Wrap::mirror)),
                        std::make_shared<const Texture>(Texture{Checker{12, {1, 1, 1}, {0, 0.5, 0}}})})
    for (const char* filter :
         {R"({"filter": "nearest"})", R"({"filter": "bilinear"})", R"({"filter": "trilinear"})",
          R"({"filter": "catmull_rom"})", R"({"filter": "ewa"})"})
      EXPECT_EQ(test::break_of_tile_law(
                    {nodes::texture_sample(), filter, {{"points", {points}}, {"texture", {t}}}}),
                "");
}

// ----- the node, from materials

// A texture of one colour.
Ref<Texture> flat_texture(float r, float g, float b) {
  return texture(MipPyramid{.levels = {{1, 1, {r, g, b, 1}}}});
}

// Points of faces 0 to 3 in vertical stripes of three pixels, nothing in every fifth column.
Ref<Image> striped_points(bool with_uv1, bool with_color) {
  Frame f{.window = {0, 0, 30, 4}, .planes = {{"id", PlaneKind::u32}}};
  for (const char* name : {"uv.u", "uv.v", "uv.du_dx", "uv.dv_dx", "uv.du_dy", "uv.dv_dy"})
    f.planes.push_back({name});
  if (with_uv1)
    for (const char* name : {"uv1.u", "uv1.v", "uv1.du_dx", "uv1.dv_dx", "uv1.du_dy", "uv1.dv_dy"})
      f.planes.push_back({name});
  if (with_color)
    for (const char* name : {"color.x", "color.y", "color.z"}) f.planes.push_back({name});
  Raster r(f);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 30; ++x) {
      r.view().row<std::uint32_t>(0, 0, y)[x] = x % 5 == 4 ? no_face : static_cast<std::uint32_t>(x / 3 % 4);
      const auto put = [&](std::string_view plane, float v) {
        if (const auto i = f.find(plane)) r.view().row<float>(*i, 0, y)[x] = v;
      };
      put("uv.u", 0.25F), put("uv.v", 0.25F), put("uv1.u", 0.75F), put("uv1.v", 0.25F);
      put("color.x", 0.5F), put("color.y", 1), put("color.z", 0.25F);
    }
  return std::make_shared<Image>(Image{r});
}

Ref<Mesh> dressed_mesh(std::vector<Material> materials, std::vector<std::uint32_t> of) {
  auto m = std::make_shared<Mesh>();
  const glm::vec3 position[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<glm::uvec3> triangle(of.size(), glm::uvec3(0, 1, 2));
  m->columns = {Column::make<glm::vec3>("position", Domain::vertex, position, Space::world),
                Column::make<glm::uvec3>("triangle", Domain::face, std::span<const glm::uvec3>(triangle)),
                Column::make<std::uint32_t>("material", Domain::face, std::span<const std::uint32_t>(of))};
  m->materials = std::make_shared<MaterialSet>(MaterialSet{std::move(materials)});
  return m;
}

TEST(TextureSample, EachFaceTakesTheTextureOfItsMaterial) {
  const std::vector<Material> materials = {Material{.texture = flat_texture(1, 0, 0)}, Material{},
                                           Material{.texture = flat_texture(0, 0.5F, 0)}};
  const auto mesh = dressed_mesh(materials, {2, 0, 1, 0});
  const glm::vec3 expected[4] = {{0, 0.5F, 0}, {1, 0, 0}, {1, 1, 1}, {1, 0, 0}};
  for (const bool with_color : {false, true}) {
    const auto points = striped_points(false, with_color);
    const glm::vec3 tint = with_color ? glm::vec3(0.5F, 1, 0.25F) : glm::vec3(1);
    const test::PixelRun run(nodes::texture_sample(), "{}", {{"points", {points}}, {"mesh", {mesh}}});
    EXPECT_EQ(test::break_of_tile_law(run), "");
    const Raster image = run.whole();
    for (int x = 0; x < 30; ++x) {
      const bool covered = x % 5 != 4;
      for (int k = 0; k < 3; ++k)
        EXPECT_EQ(image.at<float>(k, 0, x, 2), covered ? expected[x / 3 % 4][k] * tint[k] : 0.0F)
            << x << " " << k;
      EXPECT_EQ(image.at<float>(3, 0, x, 2), covered ? 1.0F : 0.0F);
    }
  }
}

// One texel of opacity a, red, premultiplied; what has less than `cutoff` is not there.
Ref<Texture> clear_texture(float a, double cutoff) {
  return texture(MipPyramid{.levels = {{1, 1, {a, 0, 0, a}}}, .alpha_cutoff = cutoff});
}

TEST(TextureSample, CutoffsMakeWhatIsLookedUpOpaqueOrNothing) {
  const std::vector<Material> materials = {
      Material{.texture = clear_texture(0.25F, 0)}, Material{.texture = clear_texture(0.25F, 0.25)},
      Material{.texture = clear_texture(0.25F, 0.26)}, Material{.texture = clear_texture(1, 2)}};
  const auto mesh = dressed_mesh(materials, {0, 1, 2, 3});
  const double red[4] = {0.25, 1, 0, 0}, alpha[4] = {0.25, 1, 0, 0};
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const test::PixelRun run(nodes::texture_sample(), "{}",
                             {{"points", {striped_points(false, false)}}, {"mesh", {mesh}}}, precision);
    EXPECT_EQ(test::break_of_tile_law(run), "");
    const Raster image = run.whole();
    for (int x = 0; x < 30; ++x) {
      const std::size_t face = static_cast<std::size_t>(x / 3 % 4);
      EXPECT_EQ(image.value(0, 0, x, 1), x % 5 == 4 ? 0 : red[face]) << x;
      EXPECT_EQ(image.value(3, 0, x, 1), x % 5 == 4 ? 0 : alpha[face]) << x;
    }
  }
  // One for everything, with a cutoff and without.
  for (const auto& [cutoff, there] : {std::pair{0.5, 0.0}, std::pair{0.125, 1.0}}) {
    const Raster image = test::PixelRun(nodes::texture_sample(), "{}",
                                        {{"points", {striped_points(false, false)}},
                                         {"texture", {clear_texture(0.25F, cutoff)}}})
                             .whole();
    EXPECT_EQ(image.value(3, 0, 0, 0), there);
    EXPECT_EQ(image.value(0, 0, 0, 0), there);
    EXPECT_EQ(image.value(3, 0, 4, 0), 0) << "nothing seen";
  }
}

TEST(TextureSample, MaterialsChooseTheirCoordinatesAndMoveThem) {
  // Four texels: red and green above, blue and white below.
  const auto four = texture(MipPyramid{.levels = {{2, 2, {1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 1, 1, 1, 1}}}});
  glm::dmat3 up(1);
  up[2] = {0, 0.5, 1};
  const std::vector<Material> materials = {Material{.texture = four}, Material{.texture = four, .uv_set = 1},
                                           Material{.texture = four, .texture_from_uv = up}};
  const auto mesh = dressed_mesh(materials, {0, 1, 2, 0});
  for (const Precision precision : {Precision::single, Precision::real_double}) {
    const test::PixelRun run(nodes::texture_sample(), R"({"filter": "nearest"})",
                             {{"points", {striped_points(true, false)}}, {"mesh", {mesh}}}, precision);
    EXPECT_EQ(test::break_of_tile_law(run), "");
    const Raster image = run.whole();
    const auto color = [&](int x) {
      return glm::dvec3(image.value(0, 0, x, 1), image.value(1, 0, x, 1), image.value(2, 0, x, 1));
    };
    EXPECT_EQ(color(0), glm::dvec3(0, 0, 1)) << "(0.25, 0.25)";
    EXPECT_EQ(color(3), glm::dvec3(1, 1, 1)) << "(0.75, 0.25)";
    EXPECT_EQ(color(6), glm::dvec3(1, 0, 0)) << "(0.25, 0.75)";
  }
}

TEST(TextureSample, CoordinatesAreAskedForWhereATextureNeedsThem) {
  const Ref<Image> ids = std::make_shared<Image>(
      Image{Raster(Frame{.window = {0, 0, 4, 4}, .planes = {{"id", PlaneKind::u32}}})});
  const auto code_of = [&](test::NodeInputs in) -> std::string {
    in["points"] = {ids};
    try {
      test::PixelRun(nodes::texture_sample(), "{}", std::move(in));
    } catch (const NodeError& e) {
      return e.code;
    }
    return "";
  };
  const std::vector<Material> materials = {Material{}, Material{.texture = flat_texture(1, 0, 0)}};
  EXPECT_EQ(code_of({{"mesh", {dressed_mesh(materials, {0, 0})}}}), "") << "no face has the texture";
  EXPECT_EQ(code_of({{"mesh", {dressed_mesh(materials, {0, 1})}}}), "missing_uv");
  EXPECT_EQ(code_of({{"mesh", {dressed_mesh(materials, {0, 2})}}}), "bad_material");
  EXPECT_EQ(code_of({}), "missing_texture");
  const Ref<Material> plain = std::make_shared<Material>();
  EXPECT_EQ(code_of({{"mesh", {dressed_mesh(materials, {0, 1})}}, {"material", {plain}}}), "");
}

TEST(TextureSample, AConstantTextureGivesItsBitsAndNothingWhereNothingIsSeen) {
  MipPyramid p = random_pyramid(24, 24, Wrap::repeat, Wrap::clamp);
  for (auto& level : p.levels)
    for (std::size_t i = 0; i < level.rgba.size(); ++i)
      level.rgba[i] = std::array{0.1F, 0.7F, 0.33F, 1.0F}[i % 4];
  const auto points = points_image({0, 0, 40, 9}, 1, 0.07F);
  const Raster image =
      test::PixelRun(nodes::texture_sample(), "{}", {{"points", {points}}, {"texture", {texture(p)}}})
          .whole();
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool covered = points->raster.at<std::uint32_t>(0, 0, x, y) != no_face;
      EXPECT_EQ(image.at<float>(1, 0, x, y), covered ? 0.7F : 0.0F);
      EXPECT_EQ(image.at<float>(3, 0, x, y), covered ? 1.0F : 0.0F);
    }
}

TEST(TextureSample, TexelCentresAreTheTexelsAndRowZeroIsTheTop) {
  const MipPyramid p = random_pyramid(8, 4, Wrap::repeat, Wrap::repeat);
  const auto levels = levels_of(p);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 8; ++i) {
      const auto c = kernels::bilinear<double>({levels}, levels[0], (i + 0.5) / 8, (j + 0.5) / 4);
      EXPECT_EQ(c[2], p.levels[0].rgba[static_cast<std::size_t>(j * 8 + i) * 4 + 2]);
    }
  Points top;
  top.add(0.5F / 8, 1.0F - 0.5F / 4, 0);
  float r = -1;
  kernels::look_up(kernels::TexelPyramid{levels}, kernels::Lookup::bilinear, top.rows(), 1,
                   {{&r, nullptr, nullptr, nullptr}});
  EXPECT_EQ(r, p.levels[0].rgba[0]);
}

TEST(TextureSample, RepeatBlendsAcrossTheSeam) {
  const MipPyramid p = random_pyramid(4, 1, Wrap::repeat, Wrap::repeat);
  const auto levels = levels_of(p);
  const auto c = kernels::bilinear<double>({levels}, levels[0], 0.0, 0.5);
  EXPECT_NEAR(c[0], 0.5 * (static_cast<double>(p.levels[0].rgba[0]) + p.levels[0].rgba[12]), 1e-15);
}

TEST(TextureSample, AFootprintOfTwoTexelsReadsTheNextLevel) {
  const kernels::TexelLevel base{64, 32, nullptr};
  for (int k = 0; k < 6; ++k)  // exactly level k, by powers of two
    EXPECT_EQ(kernels::pyramid_level(std::ldexp(1.0F, k) / 64, 0.0F, 0.0F, 0.25F / 32, base, 6),
              static_cast<float>(k));
  EXPECT_EQ(kernels::pyramid_level(0.0F, 0.0F, 0.0F, 0.0F, base, 6), 0.0F);
  EXPECT_EQ(kernels::pyramid_level(nan, 0.0F, 0.0F, 0.0F, base, 6), 6.0F);
  EXPECT_EQ(kernels::pyramid_level(0.0F, inf, 0.0F, 0.0F, base, 6), 6.0F);
}

TEST(TextureSample, LevelErrorStaysBelowItsBound) {
  for (int i = 0; i < (1 << 16); ++i) {
    const float x = std::bit_cast<float>(0x00800000u + static_cast<std::uint32_t>(i) * 32749u % 0x7F000000u);
    ASSERT_NEAR(kernels::log2_of_footprint(x), std::log2(static_cast<double>(x)), 7.3e-6 + 128 * 0x1p-24)
        << x;
  }
}

TEST(TextureSample, DoubleFollowsSingle) {
  const auto t = texture(random_pyramid(32, 20, Wrap::repeat, Wrap::repeat));
  const Raster a = test::PixelRun(nodes::texture_sample(), "{}",
                                  {{"points", {points_image({0, 0, 50, 20}, 1, 0.03F)}}, {"texture", {t}}})
                       .whole();
  const Raster b =
      test::PixelRun(nodes::texture_sample(), "{}",
                     {{"points", {points_image({0, 0, 50, 20}, 1, 0.03F, PlaneKind::f64)}}, {"texture", {t}}},
                     Precision::real_double)
          .whole();
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 50;
         ++x)  // texel coordinates carry 2^-24 of 32, levels 1e-5; texels differ by 1 at most
      EXPECT_NEAR(a.value(0, 0, x, y), b.value(0, 0, x, y), 3e-5);
}

TEST(TextureSample, PlanesThatAreMissingOrTooPreciseAreNamed) {
  const auto t = texture(random_pyramid(4, 4, Wrap::repeat, Wrap::repeat));
  const auto code_of = [&](Ref<Image> points) -> std::string {
    try {
      test::PixelRun(nodes::texture_sample(), "{}", {{"points", {points}}, {"texture", {t}}});
    } catch (const NodeError& e) {
      return e.code;
    }
    return "";
  };
  EXPECT_EQ(code_of(points_image({0, 0, 2, 2}, 1, 0, PlaneKind::f64)), "narrowing");
  EXPECT_EQ(code_of(std::make_shared<Image>(Image{Raster(Frame{.window = {0, 0, 2, 2}, .planes = {{"R"}}})})),
            "missing_plane");
}

}  // namespace
}  // namespace frustum
