#include "nodes/visibility/abuffer.h"

#include "nodes/rasterize.h"
#include "nodes/visibility.h"
#include "runtime/buffers/texture.h"
#include "tests/nodes/rasterize/screen_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace frustum {
namespace {

using test::buffer_of;
using test::ScreenMeshMaker;

// Squares of 4 px at the given depths, two triangles each; square i has the opacity i mod opacities.
std::shared_ptr<Mesh> squares(const std::vector<double>& depths, const std::vector<double>& opacities,
                              glm::ivec2 size = {4, 4}) {
  ScreenMeshMaker<float> m;
  std::vector<float> transparency;
  for (const double z : depths) {
    const std::uint32_t a = m.vertex(0, 0, z), b = m.vertex(4, 0, z), c = m.vertex(4, 4, z),
                        d = m.vertex(0, 4, z);
    m.face.emplace_back(a, b, c);
    m.face.emplace_back(a, c, d);
    for (int k = 0; k < 2; ++k)
      transparency.push_back(static_cast<float>(1 - opacities[(m.face.size() / 2 - 1) % opacities.size()]));
  }
  auto mesh = m.make(size);
  mesh->columns.push_back(Column::make("transparency", Domain::face, std::span<const float>(transparency)));
  return mesh;
}

Raster layers(const std::shared_ptr<Mesh>& mesh, const char* params = "{}", Context* ctx = nullptr,
              std::shared_ptr<SamplePattern> pattern = nullptr, int tile_edge = 0) {
  test::NodeInputs in{{buffer_of(mesh)}, {}};
  if (pattern) in[1].push_back(buffer_of(pattern));
  return test::run_node(nodes::visibility_abuffer(), nlohmann::json::parse(params), in, ctx, {}, tile_edge)[0]
      .as<Visibility>()
      ->raster;
}

bool same_bytes(const Raster& a, const Raster& b) {
  const Tile s = a.view(), t = b.view();
  if (a.frame().window != b.frame().window || a.frame().planes != b.frame().planes ||
      s.samples() != t.samples())
    return false;
  for (int k = 0; k < s.samples(); ++k)
    for (int y = s.rect().y0; y < s.rect().y1; ++y) {
      const auto n = static_cast<std::size_t>(s.rect().width());
      if (std::memcmp(s.row<std::uint32_t>(0, k, y), t.row<std::uint32_t>(0, k, y), 4 * n) != 0 ||
          std::memcmp(s.row<float>(1, k, y), t.row<float>(1, k, y), 4 * n) != 0)
        return false;
    }
  return true;
}

// Two opaque squares, one behind the other: what shading takes for them may have holes.
TEST(VisibilityAbuffer, WhatATextureShowsThroughIsKept) {
  auto mesh = squares({0.25, 0.5}, {1});
  const auto texel = [](float alpha, double cutoff) {
    return std::make_shared<const Texture>(
        MipPyramid{.levels = {{1, 1, {alpha, 0, 0, alpha}}}, .alpha_cutoff = cutoff});
  };
  const auto samples = [&](const test::NodeInputs& in) {
    return test::run_node(nodes::visibility_abuffer(), nlohmann::json::object(), in)[0]
        .as<Visibility>()
        ->raster.frame()
        .samples();
  };
  const auto with = [&](const Ref<Texture>& texture) { return Buffer(texture); };
  const auto of = [&](const Ref<Texture>& texture) {
    return Buffer(std::make_shared<const Material>(Material{.texture = texture}));
  };
  const Buffer seen = buffer_of(mesh);
  EXPECT_EQ(samples({{seen}}), 1);
  EXPECT_EQ(samples({{seen}, {}, {}, {with(texel(1, 0))}}), 1);
  EXPECT_EQ(samples({{seen}, {}, {}, {with(texel(0.5F, 0))}}), 2);
  EXPECT_EQ(samples({{seen}, {}, {}, {with(texel(0.5F, 0.5))}}), 2) << "a cutoff decides later";
  EXPECT_EQ(samples({{seen}, {}, {}, {with(texel(1, 2))}}), 2) << "nothing of it is there";
  EXPECT_EQ(samples({{seen}, {}, {of(texel(0.5F, 0))}}), 2);
  EXPECT_EQ(samples({{seen}, {}, {of(texel(0.5F, 0))}, {with(texel(1, 0))}}), 1) << "the texture is taken";
  auto dressed = std::make_shared<Mesh>(*mesh);
  dressed->materials = std::make_shared<const MaterialSet>(
      MaterialSet{{Material{.texture = texel(0.5F, 0)}, Material{.texture = texel(1, 0)}}});
  for (const std::uint32_t front : {0u, 1u}) {
    const std::uint32_t number[] = {front, front, 1, 1};
    const Mesh m = dressed->with(Column::make<std::uint32_t>("material", Domain::face, number));
    EXPECT_EQ(samples({{buffer_of(std::make_shared<Mesh>(m))}}), front == 0 ? 2 : 1);
  }
  const std::vector<glm::vec4> color(mesh->vertices(), glm::vec4(1, 1, 1, 0.5F));
  const Mesh faint = mesh->with(Column::make<glm::vec4>("color", Domain::vertex, color));
  EXPECT_EQ(samples({{buffer_of(std::make_shared<Mesh>(faint))}}), 2);
}

std::vector<std::uint32_t> list_at(const Raster& r, int x, int y, int samples = 1, int sample = 0) {
  std::vector<std::uint32_t> ids;
  for (int k = sample; k < r.frame().samples(); k += samples) ids.push_back(r.at<std::uint32_t>(0, k, x, y));
  return ids;
}

TEST(VisibilityAbuffer, ListsFacesFromTheNearestToTheFarthest) {
  const Raster r = layers(squares({0.75, 0.25, 0.5}, {0.5}));
  EXPECT_EQ(r.frame().samples(), 3);
  // Of the two triangles of a square the first lies above the diagonal, the second below.
  EXPECT_EQ(list_at(r, 3, 0), (std::vector<std::uint32_t>{2, 4, 0}));
  EXPECT_EQ(list_at(r, 0, 3), (std::vector<std::uint32_t>{3, 5, 1}));
  for (int k = 0; k < 3; ++k) EXPECT_EQ(r.value(1, k, 3, 0), 0.25 + 0.25 * k);
}

TEST(VisibilityAbuffer, EqualDepthsAreInTheOrderOfTheirSources) {
  auto mesh = squares({0.5, 0.5, 0.5}, {0.5});
  const std::vector<std::uint32_t> origin{7, 7, 3, 3, 5, 5};
  mesh->columns.push_back(Column::make("origin", Domain::face, std::span<const std::uint32_t>(origin)));
  EXPECT_EQ(list_at(layers(mesh), 3, 0), (std::vector<std::uint32_t>{2, 4, 0}));
}

TEST(VisibilityAbuffer, NothingIsListedBehindAnOpaqueFace) {
  // Depths 0.2 (glass), 0.4 (opaque), 0.6 (glass), 0.8 (opaque).
  const auto mesh = squares({0.6, 0.8, 0.2, 0.4}, {0.5, 1});
  const Raster r = layers(mesh);
  EXPECT_EQ(list_at(r, 3, 0), (std::vector<std::uint32_t>{4, 6}));
  // As near as the opaque face: only what comes before it in order stays in front.
  EXPECT_EQ(list_at(layers(squares({0.5, 0.5, 0.5}, {0.5, 1})), 3, 0), (std::vector<std::uint32_t>{0, 2}));
  EffectPolicy skip{.skipped = {"hidden_by_opaque"}};
  Context ctx;
  ctx.effects = &skip;
  EXPECT_EQ(list_at(layers(mesh, "{}", &ctx), 3, 0), (std::vector<std::uint32_t>{4, 6, 0, 2}))
      << "not asked for, all are listed";
}

TEST(VisibilityAbuffer, OpaqueMeshesHaveTheLayerOfTheZBuffer) {
  auto pattern = std::make_shared<SamplePattern>();
  *pattern = {4, 1, {100, 2000, 3000, 4000}, {3000, 900, 4000, 1200}};
  const auto mesh = squares({0.75, 0.25, 0.5}, {1});
  const Raster a = layers(mesh, "{}", nullptr, pattern);
  const auto z = test::run_node(nodes::rasterize_triangles(), nlohmann::json::object(),
                                {{buffer_of(mesh)}, {buffer_of(pattern)}});
  EXPECT_TRUE(same_bytes(a, z[0].as<Visibility>()->raster));
}

TEST(VisibilityAbuffer, SamplesRepeatLayerByLayer) {
  auto pattern = std::make_shared<SamplePattern>();
  *pattern = {2, 1, {100, 2000}, {3000, 900}};
  const Raster r = layers(squares({0.75, 0.25, 0.5}, {0.5}), "{}", nullptr, pattern);
  EXPECT_EQ(r.frame().pattern->samples, 6);
  EXPECT_EQ(r.frame().pattern->x, (std::vector<std::uint16_t>{100, 2000, 100, 2000, 100, 2000}));
  EXPECT_EQ(r.frame().pattern->y, (std::vector<std::uint16_t>{3000, 900, 3000, 900, 3000, 900}));
  for (const int sample : {0, 1})
    EXPECT_EQ(list_at(r, 3, 0, 2, sample), (std::vector<std::uint32_t>{2, 4, 0}));
}

TEST(VisibilityAbuffer, KeepsTheNearestAndSaysWhatItDropped) {
  Context ctx;
  const Raster r = layers(squares({0.9, 0.1, 0.5, 0.3, 0.7}, {0.5}), R"({"max_layers": 2})", &ctx);
  EXPECT_EQ(list_at(r, 3, 0), (std::vector<std::uint32_t>{2, 6}));
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].first, "fragments_dropped");
  EXPECT_EQ(ctx.warnings()[0].second,
            "48 of 80 fragments lie behind the 2 layers that max_layers keeps; all need 5");
  EXPECT_THAT(ctx.counters(),
              testing::Contains(std::pair<std::string, std::uint64_t>{"fragments_dropped", 48}));
}

TEST(VisibilityAbuffer, AnEmptyMeshHasOneEmptyLayer) {
  const Raster r = layers(ScreenMeshMaker<float>().make({7, 5}));
  EXPECT_EQ(r.frame().samples(), 1);
  EXPECT_EQ(list_at(r, 6, 4), (std::vector<std::uint32_t>{no_face}));
  EXPECT_EQ(r.value(1, 0, 6, 4), 1.0);
}

TEST(VisibilityAbuffer, RefusesMoreLayersThanAPixelHolds) {
  auto pattern = std::make_shared<SamplePattern>();
  pattern->samples = 1024;
  pattern->x.assign(1024, 2048), pattern->y.assign(1024, 2048);
  const auto error = test::run_error(
      nodes::visibility_abuffer(), nlohmann::json::object(),
      {{buffer_of(squares(std::vector<double>(65, 0.5), {0.5}, {1, 1}))}, {buffer_of(pattern)}});
  EXPECT_EQ(error.first, "too_many_layers");
}

TEST(VisibilityAbuffer, KeepsTheLawOfTiles) {
  auto pattern = std::make_shared<SamplePattern>();
  *pattern = {2, 1, {100, 2000}, {3000, 900}};
  for (const char* params : {"{}", R"({"max_layers": 2})"}) {
    const auto mesh = squares({0.9, 0.1, 0.5, 0.3, 0.7}, {0.5, 0.5, 1}, {43, 21});
    const Raster whole = layers(mesh, params, nullptr, pattern);
    for (const int edge : {1, 5, 16})
      EXPECT_TRUE(same_bytes(layers(mesh, params, nullptr, pattern, edge), whole)) << params << " " << edge;
  }
}

}  // namespace
}  // namespace frustum
