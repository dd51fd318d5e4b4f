// What alphaMode of glTF and d of MTL mean, from the file to the picture: a card in front of a green wall.
#include "runtime/buffers/mesh.h"
#include "runtime/io/texture_png.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/session_run.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace frustum {
namespace {

using test::GltfMaker;
using testing::HasSubstr;
using Tree = nlohmann::json;

constexpr int size = 16;

// Two texels, left and right, of straight red with these opacities.
std::string red_png(float left, float right) {
  MipPyramid p;
  p.levels.push_back({2, 1, {left, 0, 0, left, right, 0, 0, right}});
  return texture_png(p, "test").bytes;
}

// A square of 2 by 2 at depth z that fills the picture, unlit; u from left to right.
std::size_t add_square(GltfMaker& g, float z, Tree material, const std::vector<float>& color = {}) {
  const std::size_t p = g.accessor<float>({-1, -1, z, 1, -1, z, 1, 1, z, -1, 1, z}, "VEC3"),
                    uv = g.accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2"),
                    index = g.accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR");
  Tree attributes = {{"POSITION", p}, {"TEXCOORD_0", uv}};
  if (!color.empty()) attributes["COLOR_0"] = g.accessor<float>(color, "VEC4");
  material["extensions"]["KHR_materials_unlit"] = Tree::object();
  g.document["materials"].push_back(std::move(material));
  return g.mesh(
      {{"attributes", attributes}, {"indices", index}, {"material", g.document["materials"].size() - 1}});
}

struct Card {
  Tree material = Tree::object();
  std::vector<float> opacity = {};  // of the two texels; empty: no texture, and red
  std::vector<float> color = {};    // of the four vertices, red green blue alpha
};

std::string scene_of(const Card& card) {
  GltfMaker g;
  Tree material = card.material;
  material["pbrMetallicRoughness"]["metallicFactor"] = 0;
  if (card.opacity.empty()) {
    Tree& base = material["pbrMetallicRoughness"]["baseColorFactor"];
    base = {1, 0, 0, base.is_null() ? Tree(1) : base.at(3)};
  } else {
    material["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    g.document["images"] = {
        {{"bufferView", g.view(red_png(card.opacity[0], card.opacity[1]))}, {"mimeType", "image/png"}}};
    g.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};
    g.document["textures"] = {{{"source", 0}, {"sampler", 0}}};
  }
  g.node({{"mesh", add_square(g, 0, material, card.color)}});
  const Tree green = {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 1, 0, 1}}, {"metallicFactor", 0}}}};
  g.node({{"mesh", add_square(g, -0.001F, green)}});
  return g.glb();
}

std::string graph_of(std::string_view file, std::string_view library,
                     std::string_view reader = "io.load_scene", std::string_view rate = "pixel") {
  return fmt::format(R"({{
  "format": "frustum.graph/1",
  "params": {{ "resolution": [{}, {}], "samples": 4 }},
  "nodes": {{
    "scene":  {{ "type": "{}", "params": {{ "file": "{}" }} }},
    "camera": {{ "type": "scene.camera", "params": {{ "eye": [0, 0, 10], "target": [0, 0, 0], "fov_y": 11, "resolution": "$resolution" }} }},
    "sky":    {{ "type": "light.ambient", "params": {{ "color": [1, 1, 1] }} }},
    "draw":   {{ "type": "graph", "file": "{}", "params": {{ "samples": "$samples" }}, "overrides": {{ "lit:rate": "{}", "pixels:filter": "box" }},
                "in": {{ "mesh": "scene.mesh", "camera": "camera", "lights": ["sky"] }} }} }},
  "outputs": {{ "beauty": {{ "from": "draw.image" }}, "mesh": {{ "from": "scene.mesh" }} }} }})",
                     size, size, reader, file, library, rate);
}

using Rgba = std::array<double, 4>;

Rgba pixel(const Raster& r, int x) {
  const int y = size / 2 - 3;
  return {r.value(0, 0, x, y), r.value(1, 0, x, y), r.value(2, 0, x, y), r.value(3, 0, x, y)};
}

struct Seen {
  Rgba left, right;
  std::string said;
};

Seen see(const Card& card, std::string_view library = "lib:abuffer", std::string_view rate = "pixel") {
  test::TempFolder folder;
  folder.write("card.glb", scene_of(card));
  const auto run =
      test::run_in_session(folder, graph_of("card.glb", library, "io.load_scene", rate), {"beauty"});
  if (run.result.end != RunResult::End::done) throw std::runtime_error(run.said());
  return {pixel(run.image(), 1), pixel(run.image(), size - 2), run.said()};
}

void expect_near(const Rgba& got, const Rgba& want) {
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(got[c], want[c], 2e-6) << "channel " << c;
}

// Red of this opacity over green.
Rgba over_green(double opacity) { return {opacity, 1 - opacity, 0, 1}; }

constexpr float quarter = 51 / 255.0F, most = 204 / 255.0F;  // 0.2 and 0.8, in 8 bits

TEST(GltfAlpha, BlendIsTheProductOfFactorTextureAndVertices) {
  const Card card{.material = {{"alphaMode", "BLEND"}}, .opacity = {quarter, most}};
  expect_near(see(card).left, over_green(quarter));
  expect_near(see(card).right, over_green(most));
  expect_near(see(card, "lib:abuffer", "sample").left, over_green(quarter));
  Card faint = card;
  faint.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  expect_near(see(faint).left, over_green(quarter / 2));
  expect_near(see(faint).right, over_green(most / 2));
  Card plain{.material = {{"alphaMode", "BLEND"}}};
  plain.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 0.25};
  expect_near(see(plain).left, over_green(0.25));
  std::vector<float> clear;
  for (int v = 0; v < 4; ++v) clear.insert(clear.end(), {1, 1, 1, 0.5F});
  plain.color = clear;
  expect_near(see(plain).left, over_green(0.125));
}

TEST(GltfAlpha, MaskIsThereOrNot) {
  const Card card{.material = {{"alphaMode", "MASK"}}, .opacity = {quarter, most}};
  for (const char* rate : {"pixel", "sample"}) {
    expect_near(see(card, "lib:abuffer", rate).left, over_green(0));
    expect_near(see(card, "lib:abuffer", rate).right, over_green(1));
  }
  // The factor counts before the comparison: 0.8 x 0.5 is below 0.5, and above 0.3.
  Card faint = card;
  faint.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.5};
  expect_near(see(faint).right, over_green(0));
  faint.material["alphaCutoff"] = 0.3;
  expect_near(see(faint).right, over_green(1));
  expect_near(see(faint).left, over_green(0));
  for (const auto& [cutoff, there] : {std::pair{0.0, 1.0}, std::pair{1.0, 0.0}, std::pair{1.5, 0.0}}) {
    Card all = card;
    all.material["alphaCutoff"] = cutoff;
    expect_near(see(all).left, over_green(there));
  }
  // Vertices count with the texture: 0.8 x 0.5.
  Card dim = card;
  for (int v = 0; v < 4; ++v) dim.color.insert(dim.color.end(), {1, 1, 1, 0.5F});
  expect_near(see(dim).right, over_green(0));
  // Without a texture, factor and cutoff decide alone.
  for (const auto& [alpha, there] : {std::pair{0.4, 0.0}, std::pair{0.6, 1.0}}) {
    Card plain{.material = {{"alphaMode", "MASK"}}};
    plain.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, alpha};
    expect_near(see(plain).left, over_green(there));
  }
}

TEST(GltfAlpha, OpaqueIgnoresAllOfIt) {
  Card card{.opacity = {quarter, most}};
  card.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 0.25};
  for (int v = 0; v < 4; ++v) card.color.insert(card.color.end(), {1, 1, 1, 0.5F});
  for (const char* library : {"lib:abuffer", "lib:raster"}) {
    expect_near(see(card, library).left, over_green(1));
    EXPECT_THAT(see(card, library).said, testing::Not(HasSubstr("opaque"))) << library;
  }
}

// Where only the nearest face is kept, nothing is behind: that is said, and the picture shows the background there.
TEST(GltfAlpha, WithoutListsOfFragmentsWhatIsBehindIsMissingAndSaidSo) {
  const Card card{.material = {{"alphaMode", "MASK"}}, .opacity = {quarter, most}};
  const Seen seen = see(card, "lib:raster");
  expect_near(seen.left, {0, 0, 0, 0});
  expect_near(seen.right, over_green(1));
  EXPECT_THAT(seen.said, HasSubstr("nothing_shows_through: face 0 is not opaque"));
}

TEST(GltfAlpha, FacesCarryItAsTransparency) {
  test::TempFolder folder;
  Card card{.material = {{"alphaMode", "BLEND"}}};
  card.material["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0, 0, 0.25};
  folder.write("card.glb", scene_of(card));
  const auto run = test::run_in_session(folder, graph_of("card.glb", "lib:raster"), {"mesh"});
  const auto mesh = run.buffers.at(0).as<Mesh>();
  const auto clear = mesh->at("transparency").values<float>();
  EXPECT_THAT(std::vector<float>(clear.begin(), clear.end()), testing::ElementsAre(0.75F, 0.75F, 0, 0));
}

TEST(MtlOpacity, BlendsFacesByDOrTr) {
  for (const auto& [line, opacity] : {std::pair{"d 0.25", 0.25}, std::pair{"Tr 0.75", 0.25},
                                      std::pair{"Tr 0.5\nd 0.25", 0.25}, std::pair{"d 1", 1.0}}) {
    test::TempFolder folder;
    folder.write("m.mtl", fmt::format("newmtl red\nKd 1 0 0\nKa 1 0 0\nKs 0 0 0\n{}\n"
                                      "newmtl green\nKd 0 1 0\nKa 0 1 0\nKs 0 0 0\n",
                                      line));
    folder.write("card.obj",
                 "mtllib m.mtl\nvn 0 0 1\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                 "v -1 -1 -.001\nv 1 -1 -.001\nv 1 1 -.001\nv -1 1 -.001\n"
                 "usemtl red\nf 1//1 2//1 3//1 4//1\nusemtl green\nf 5//1 6//1 7//1 8//1\n");
    const auto run =
        test::run_in_session(folder, graph_of("card.obj", "lib:abuffer", "io.load_mesh"), {"beauty"});
    ASSERT_EQ(run.result.end, RunResult::End::done) << run.said();
    expect_near(pixel(run.image(), 1), over_green(opacity));
    EXPECT_EQ(run.said(), "") << line;
  }
}

}  // namespace
}  // namespace frustum
