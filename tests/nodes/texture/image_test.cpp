#include "nodes/texture/image.h"

#include "nodes/io.h"
#include "nodes/kernels/half.h"
#include "nodes/kernels/image_pyramid.h"
#include "nodes/texture.h"
#include "runtime/buffers/image.h"
#include "runtime/buffers/texture.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

Image constant(Rect window, PlaneList planes, std::vector<float> values, std::string space, Alpha alpha) {
  const Raster r(
      Frame{.window = window, .planes = std::move(planes), .color_space = std::move(space), .alpha = alpha});
  for (int p = 0; p < static_cast<int>(values.size()); ++p)
    for (int y = window.y0; y < window.y1; ++y)
      std::fill_n(r.view().row<float>(p, 0, y), window.width(), values[static_cast<std::size_t>(p)]);
  return {r};
}

MipPyramid texture_of(Image image, const Json& params = Json::object()) {
  const auto out =
      test::run_node(nodes::texture_image(), params, {{std::make_shared<const Image>(std::move(image))}});
  return std::get<MipPyramid>(out.at(0).as<Texture>()->source);
}

TEST(TextureImage, CellsCoverEveryTexelOnce) {
  for (int n = 1; n < 40; ++n) {
    const int m = std::max(1, n / 2);
    std::vector<double> covered(static_cast<std::size_t>(n));
    for (int i = 0; i < m; ++i) {
      const kernels::CellSpan s = kernels::cell_span(i, n, m);
      double sum = 0;
      for (int k = s.first; k <= s.last; ++k) {
        const double part = k == s.first ? s.first_part : k == s.last ? s.last_part : 1;
        covered[static_cast<std::size_t>(k)] += part, sum += part;
      }
      EXPECT_NEAR(sum, static_cast<double>(n) / m, 1e-12);
    }
    for (const double c : covered) EXPECT_NEAR(c, 1, 1e-12) << n;
  }
}

TEST(TextureImage, SidesHalveUntilBothAreOne) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 7}, {8, 5}, {1, 9}}) {
    const auto p =
        texture_of(constant({0, 0, width, height}, {{"R"}, {"G"}, {"B"}}, {1, 1, 1}, "", Alpha::none));
    EXPECT_EQ(static_cast<int>(p.levels.size()), pyramid_levels(width, height)) << width << " " << height;
    EXPECT_EQ(p.levels.back().width * p.levels.back().height, 1);
  }
}

TEST(TextureImage, HalvesByArea) {
  const float row[] = {1, 0, 0, 1, 2, 0, 0, 1, 6, 0,
                       0, 1, 8, 0, 0, 1, 3, 0, 0, 1};  // five texels, R = 1 2 6 8 3
  float out[8];
  kernels::halve_row(row, 5, 1, 0, out);
  EXPECT_FLOAT_EQ(out[0], (1 + 2 + 6 * 0.5f) / 2.5f);
  EXPECT_FLOAT_EQ(out[4], (6 * 0.5f + 8 + 3) / 2.5f);
  EXPECT_EQ(out[3], 1);
}

TEST(TextureImage, EveryLevelKeepsTheMean) {
  const Raster r(
      Frame{.window = {3, -2, 24, 11}, .planes = {{"R"}, {"G"}, {"B"}}, .color_space = "lin_rec709"});
  test::Random random(3);
  double sum = 0;
  for (int y = -2; y < 11; ++y)
    for (int x = 0; x < 21; ++x)
      sum += static_cast<double>(r.view().row<float>(0, 0, y)[x] = static_cast<float>(random.uniform()));
  const MipPyramid p = texture_of({r});
  ASSERT_EQ(p.levels.size(), 5u);
  const int sizes[5][2] = {{21, 13}, {10, 6}, {5, 3}, {2, 1}, {1, 1}};
  for (std::size_t l = 0; l < 5; ++l) {
    EXPECT_EQ(p.levels[l].width, sizes[l][0]);
    EXPECT_EQ(p.levels[l].height, sizes[l][1]);
    double mean = 0;
    for (std::size_t i = 0; i < p.levels[l].rgba.size(); i += 4)
      mean += static_cast<double>(p.levels[l].rgba[i]);
    EXPECT_NEAR(mean * 4 / static_cast<double>(p.levels[l].rgba.size()), sum / (21 * 13), 1e-6) << l;
    EXPECT_EQ(p.levels[l].rgba[3], 1) << "no A means opaque";
  }
}

TEST(TextureImage, BecomesLinearWithoutItsAlpha) {
  // sRGB 0.5 is 0.21404 linear; premultiplied by 1/4 it is stored as 0.125.
  const float linear = 0.21404114f;
  const PlaneList rgba{{"R"}, {"G"}, {"B"}, {"A"}};
  const MipPyramid premultiplied =
      texture_of(constant({0, 0, 2, 2}, rgba, {0.125f, 0.125f, 0.125f, 0.25f}, "srgb", Alpha::premultiplied));
  const MipPyramid straight =
      texture_of(constant({0, 0, 2, 2}, rgba, {0.5f, 0.5f, 0.5f, 0.25f}, "srgb", Alpha::straight));
  for (const MipPyramid* p : {&premultiplied, &straight})
    for (const auto& level : p->levels) {
      EXPECT_NEAR(level.rgba[0], linear * 0.25f, 1e-7);
      EXPECT_EQ(level.rgba[3], 0.25f);
    }
  EXPECT_EQ(texture_of(constant({0, 0, 2, 2}, rgba, {0.125f, 0, 0, 0.25f}, "", Alpha::premultiplied))
                .levels[0]
                .rgba[0],
            0.125f);
}

TEST(TextureImage, OnePlaneIsGreyAndTheTopRowComesFirst) {
  const Raster r(Frame{.window = {0, 0, 1, 2}, .planes = {{"height"}}});
  r.view().row<float>(0, 0, 0)[0] = 0.25f, r.view().row<float>(0, 0, 1)[0] = 0.75f;
  const MipPyramid p = texture_of({r}, {{"wrap_u", "clamp"}, {"wrap_v", "mirror"}, {"pyramid", false}});
  ASSERT_EQ(p.levels.size(), 1u);
  EXPECT_EQ(p.levels[0].rgba, (std::vector<float>{0.25f, 0.25f, 0.25f, 1, 0.75f, 0.75f, 0.75f, 1}));
  EXPECT_EQ(p.wrap_u, Wrap::clamp);
  EXPECT_EQ(p.wrap_v, Wrap::mirror);
}

TEST(TextureImage, TheNumberOfThreadsDoesNotShow) {
  const auto card = test::run_node(nodes::io_load_image(), {{"file", "card.png"}}, {}, nullptr,
                                   std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data");
  std::vector<Digest> digests;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    digests.push_back(test::run_node(nodes::texture_image(), Json::object(), {card}).at(0).digest());
  }
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_EQ(digests[0], digests[2]);
}

std::string problem(Image image) {
  return test::run_error(nodes::texture_image(), Json::object(),
                         {{std::make_shared<const Image>(std::move(image))}})
      .first;
}

TEST(TextureImage, HalfKeepsElevenBitsInHalfTheMemory) {
  const Raster r(
      Frame{.window = {0, 0, 37, 12}, .planes = {{"R"}, {"G"}, {"B"}}, .color_space = "lin_rec709"});
  test::Random random(4);
  for (int k = 0; k < 3; ++k)
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 37; ++x)
        r.view().row<float>(k, 0, y)[x] =
            std::ldexp(static_cast<float>(random.uniform()), static_cast<int>(random.below(30)) - 14);
  r.view().row<float>(0, 0, 3)[5] = -kernels::most_half;
  r.view().row<float>(1, 0, 3)[5] = std::nanf("");
  const MipPyramid single = texture_of({r}), half = texture_of({r}, {{"storage", "half"}});
  ASSERT_EQ(half.levels.size(), single.levels.size());
  for (std::size_t l = 0; l < single.levels.size(); ++l) {
    const auto& wide = single.levels[l];
    ASSERT_EQ(half.levels[l].size(), wide.size());
    EXPECT_EQ(half.levels[l].bytes() * 2, wide.bytes());
    for (std::size_t i = 0; i < wide.size(); ++i) {
      const float is = half.levels[l].number(i), should = wide.number(i);
      if (std::isnan(should))
        EXPECT_TRUE(std::isnan(is));
      else
        EXPECT_LE(std::abs(is - should), std::max(std::abs(should) * 0x1p-11F, 0x1p-25F)) << l << " " << i;
    }
  }
  EXPECT_EQ(half.levels[0].number(4 * (3 * 37 + 5)), -65504);
}

TEST(TextureImage, HalfRefusesWhatItDoesNotReach) {
  for (const float n : {65505.0F, -1e5F, std::numeric_limits<float>::infinity()}) {
    const Raster r(Frame{.window = {0, 0, 4, 4}, .planes = {{"height"}}});
    r.view().row<float>(0, 0, 2)[1] = n;
    try {
      texture_of({r}, {{"storage", "half"}});
      FAIL() << n;
    } catch (const NodeError& e) {
      EXPECT_EQ(e.code, "beyond_half");
      EXPECT_THAT(e.what(), testing::HasSubstr("texel 1,2"));
    }
    texture_of({r});
  }
}

// Every pattern of 16 bits goes there and back, and numbers between two go to the nearer.
TEST(Half, RoundsToTheNearest) {
  for (std::uint32_t bits = 0; bits < 0x7C00; ++bits) {
    const auto h = static_cast<std::uint16_t>(bits);
    const float x = kernels::from_half(h);
    ASSERT_EQ(kernels::to_half(x), h);
    ASSERT_EQ(kernels::to_half(-x), h | 0x8000);
    const double exact = (bits & 0x7C00) == 0
                             ? std::ldexp(bits & 0x3FF, -24)
                             : std::ldexp(1024 + (bits & 0x3FF), static_cast<int>(bits >> 10) - 25);
    ASSERT_EQ(static_cast<double>(x), exact);
    if (bits == 0x7BFF) break;
    const float next = kernels::from_half(static_cast<std::uint16_t>(bits + 1)), middle = (x + next) / 2;
    ASSERT_EQ(kernels::to_half(std::nextafter(middle, x)), h);
    ASSERT_EQ(kernels::to_half(std::nextafter(middle, next)), h + 1);
  }
}

TEST(TextureImage, RefusesWhatIsNoPicture) {
  EXPECT_EQ(problem({}), "empty_image");
  EXPECT_EQ(problem({Raster(Frame{.window = {0, 0, 1, 1}, .planes = {{"R"}, {"Z"}}})}), "missing_plane");
  EXPECT_EQ(problem({Raster(Frame{.window = {0, 0, 1, 1}, .planes = {{"id", PlaneKind::u32}}})}),
            "wrong_plane_kind");
  auto four = std::make_shared<SamplePattern>();
  four->samples = 4, four->x.assign(4, 0), four->y.assign(4, 0);
  EXPECT_EQ(
      problem({Raster(Frame{.window = {0, 0, 1, 1}, .pattern = four, .planes = {{"R"}, {"G"}, {"B"}}})}),
      "sampled_image");
  EXPECT_EQ(problem(constant({0, 0, 1, 1}, {{"R"}, {"G"}, {"B"}}, {0, 0, 0}, "house_log", Alpha::none)),
            "unknown_color_space");
}

}  // namespace
}  // namespace frustum
