#include "nodes/project/viewport.h"

#include "nodes/project.h"
#include "tests/support/meshes.h"
#include "tests/support/run_node.h"
#include "tests/support/ulps.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

Ref<Mesh> screen(const Mesh& m, glm::ivec2 resolution, Context* ctx = nullptr) {
  auto camera = std::make_shared<Camera>();
  camera->resolution = resolution;
  return test::run_node(nodes::project_viewport(), Json::object(), {{test::shared(m)}, {Ref<Camera>(camera)}},
                        ctx)
      .at(0)
      .as<Mesh>();
}

TEST(ProjectViewport, MapsCornersToThePictureWithYDown) {
  const std::vector<glm::vec4> p = {{-1, 1, -1, 1}, {2, -2, 1, 2}, {0, 0, 0, 4}};
  for (const glm::ivec2 size : {glm::ivec2(1280, 720), glm::ivec2(1, 1), glm::ivec2(7, 5)}) {
    const auto out = screen(test::mesh_of(p, {}, Space::clip), size);
    const auto w = static_cast<float>(size.x), h = static_cast<float>(size.y);
    EXPECT_EQ(test::column<glm::vec4>(*out, "position"),
              (std::vector<glm::vec4>{{0, 0, -1, 1}, {w, h, 0.5F, 0.5F}, {w / 2, h / 2, 0, 0.25F}}));
    EXPECT_EQ(out->space(), Space::screen);
  }
}

// The pixels are those of the NDC that project.divide shows.
TEST(ProjectViewport, AgreesWithTheDivideBitForBit) {
  test::Random random(1);
  std::vector<glm::vec4> p;
  for (int i = 0; i < 5000; ++i)
    p.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1),
                   random.uniform(0.1, 3));
  const auto m = test::mesh_of(p, {}, Space::clip);
  const auto px = test::column<glm::vec4>(*screen(m, {1920, 1080}), "position");
  const auto ndc = test::column<glm::vec3>(
      *test::run_node(nodes::project_divide(), Json::object(), {{test::shared(m)}}).at(0).as<Mesh>(),
      "position");
  const kernels::Viewport viewport({1920, 1080});
  for (std::size_t i = 0; i < p.size(); ++i)
    EXPECT_EQ(px[i], glm::vec4(viewport.x_px(ndc[i].x), viewport.y_px(ndc[i].y), ndc[i].z, 1 / p[i].w));
}

TEST(ProjectViewport, DropsFacesOnOrBehindTheEyesPlane) {
  const std::vector<glm::vec4> p = {
      {0, 0, 0, 1}, {1, 0, 0, 1}, {0, 1, 0, 1}, {1, 1, 0, -1}, {1, 1, 0, 1e-45F}};
  Context ctx;
  const auto out = screen(test::mesh_of(p, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}, Space::clip), {64, 64}, &ctx);
  EXPECT_EQ(out->faces(), 1U);  // 1/w of the last one overflows
  EXPECT_TRUE(out->at("position").health().finite());
  ASSERT_EQ(ctx.warnings().size(), 1U);
  EXPECT_EQ(ctx.warnings()[0].first, "faces_behind_the_eye");
}

TEST(ProjectViewport, RefusesAPictureWithoutPixels) {
  auto camera = std::make_shared<Camera>();
  camera->resolution = {0, 5};
  const auto m = test::shared(test::mesh_of(std::vector<glm::vec4>{}, {}, Space::clip));
  EXPECT_EQ(test::run_error(nodes::project_viewport(), Json::object(), {{m}, {Ref<Camera>(camera)}}).first,
            "impossible_camera");
  EXPECT_EQ(screen(*m, {5, 5})->vertices(), 0U);
}

}  // namespace
}  // namespace frustum
