// Meshes with materials and textures, written as glTF and read again.
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/texture.h"
#include "runtime/io/buffer_files.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/gltf.h"
#include "runtime/io/texture_png.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_problem.h"
#include "tests/support/meshes.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <numbers>

namespace frustum {
namespace {

using testing::ElementsAre;

// Texels that 8 bits of sRGB hold: 0, 1, and others after a first way there and back.
Ref<Texture> picture(int width, int height, bool opaque, Wrap u = Wrap::repeat, Wrap v = Wrap::repeat,
                     double alpha_cutoff = 0) {
  MipPyramid p{.levels = {}, .wrap_u = u, .wrap_v = v, .alpha_cutoff = alpha_cutoff};
  MipPyramid::Level level{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const float a = opaque ? 1.0F : static_cast<float>(i % 4) / 3;  // 0, 85, 170 and 255 of 255
    level.rgba.insert(level.rgba.end(), {i % 2 == 0 ? a : 0.0F, i % 3 == 0 ? a : 0.0F, a, a});
  }
  p.levels.push_back(std::move(level));
  return std::make_shared<const Texture>(std::move(p));
}

Mesh strip(std::vector<Material> materials) {
  const auto n = static_cast<std::uint32_t>(materials.size());
  std::vector<glm::vec3> position;
  std::vector<glm::uvec3> triangle;
  std::vector<glm::vec2> uv;
  std::vector<std::uint32_t> number;
  for (std::uint32_t m = 0; m < n; ++m) {
    const auto x = static_cast<float>(m);
    for (const glm::vec2 c : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(0, 1)})
      position.emplace_back(x + c.x, c.y, 0), uv.push_back(c);
    triangle.emplace_back(3 * m, 3 * m + 1, 3 * m + 2), number.push_back(m);
  }
  Mesh mesh = test::mesh_of(position, triangle, Space::world);
  const std::vector<glm::vec3> normal(position.size(), glm::vec3(0, 0, 1));
  mesh.columns.push_back(Column::make<glm::vec3>("normal", Domain::vertex, normal, Space::world));
  for (const char* name : {"uv", "uv1"})
    mesh.columns.push_back(Column::make<glm::vec2>(name, Domain::vertex, uv));
  mesh.columns.push_back(Column::make<std::uint32_t>("material", Domain::face, number));
  mesh.materials = std::make_shared<const MaterialSet>(MaterialSet{std::move(materials)});
  EXPECT_EQ(mesh.validate(), "");
  return mesh;
}

class RoundTrip : public testing::TestWithParam<const char*> {
 protected:
  Mesh there_and_back(const Mesh& mesh) {
    const std::string path = folder_.file(fmt::format("m.{}", GetParam()));
    warnings_.clear();
    Context saving;
    save_buffer_file(Ref<Mesh>(test::shared(mesh)),
                     {.path = path,
                      .metadata = {},
                      .warn = [&](std::string_view, const std::string& what) { warnings_.push_back(what); }},
                     saving);
    Context ctx;
    const FileBytes bytes({path, path});
    Mesh back = read_gltf(bytes.text(), {path, path}, true, ctx).mesh;
    for (const auto& [code, what] : ctx.warnings()) ADD_FAILURE() << code << ": " << what;
    EXPECT_EQ(back.validate(), "");
    return back;
  }
  test::TempFolder folder_;
  std::vector<std::string> warnings_;
};

void expect_same(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  for (glm::length_t k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance);
}

void expect_same(const Material& a, const Material& b) {
  SCOPED_TRACE(a.name);
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.model, b.model);
  expect_same(a.ambient, b.ambient, 0), expect_same(a.diffuse, b.diffuse, 0);
  expect_same(a.specular, b.specular, 0), expect_same(a.emission, b.emission, 1e-15);
  EXPECT_EQ(a.shininess, b.shininess);
  EXPECT_EQ(a.two_sided, b.two_sided);
  EXPECT_EQ(a.unlit, b.unlit);
  EXPECT_EQ(a.uv_set, b.uv_set);
  for (glm::length_t c = 0; c < 3; ++c)
    for (glm::length_t r = 0; r < 3; ++r)
      EXPECT_NEAR(a.texture_from_uv[c][r], b.texture_from_uv[c][r], 1e-14) << c << r;
  ASSERT_EQ(a.texture == nullptr, b.texture == nullptr);
  if (!a.texture) return;
  const auto &from = std::get<MipPyramid>(a.texture->source), &to = std::get<MipPyramid>(b.texture->source);
  EXPECT_EQ(from.wrap_u, to.wrap_u);
  EXPECT_EQ(from.wrap_v, to.wrap_v);
  EXPECT_EQ(from.alpha_cutoff, to.alpha_cutoff);
  ASSERT_EQ(from.levels[0].width, to.levels[0].width);
  ASSERT_EQ(from.levels[0].height, to.levels[0].height);
  for (std::size_t i = 0; i < from.levels[0].rgba.size(); ++i)
    ASSERT_NEAR(from.levels[0].rgba[i], to.levels[0].rgba[i], 1e-6) << i;
}

TEST_P(RoundTrip, MaterialsComeBack) {
  const Ref<Texture> shared = picture(5, 3, true, Wrap::clamp, Wrap::mirror);
  Material turned{.name = "turned", .texture = shared, .uv_set = 1};
  const double c = std::cos(0.4), s = std::sin(0.4);
  turned.texture_from_uv[0] = {2 * c, 2 * s, 0};
  turned.texture_from_uv[1] = {-0.5 * s, 0.5 * c, 0};
  turned.texture_from_uv[2] = {0.25, -3, 1};
  const Mesh mesh = strip(
      {Material{.name = "clay",
                .model = Reflection::phong,
                .ambient{0.5, 0.5, 0.5},
                .diffuse{0.7, 0.3, 0.2},
                .specular{0.4, 0.4, 0.4},
                .shininess = 60},
       Material{.name = "lamp", .emission{4, 2, 0}},
       Material{.name = "sign", .diffuse{0.2, 0.3, 0.4}, .two_sided = true, .unlit = true, .texture = shared},
       Material{.name = "leaf", .texture = picture(4, 4, false, Wrap::repeat, Wrap::repeat, 0.3)}, turned,
       Material{.name = "matt", .model = Reflection::lambert, .diffuse{1, 1, 1}}});
  const Mesh back = there_and_back(mesh);
  EXPECT_THAT(warnings_, ElementsAre());
  ASSERT_EQ(back.materials->materials.size(), mesh.materials->materials.size());
  for (std::size_t i = 0; i < mesh.materials->materials.size(); ++i)
    expect_same(mesh.materials->materials[i], back.materials->materials[i]);
  EXPECT_EQ(back.materials->materials[2].texture, back.materials->materials[4].texture) << "written once";
  EXPECT_EQ(back.vertices(), mesh.vertices()) << "six materials, and each vertex once";
  for (std::size_t f = 0; f < mesh.faces(); ++f)
    for (glm::length_t c = 0; c < 3; ++c)
      EXPECT_EQ(back.at("position").values<glm::vec3>()[back.triangles()[f][c]],
                mesh.at("position").values<glm::vec3>()[mesh.triangles()[f][c]]);
}

// A highlight of the given reflectance straight on.
Material shiny(const char* name, const glm::dvec3& diffuse, const glm::dvec3& f0, double shininess) {
  return {.name = name, .diffuse = diffuse, .specular = f0 * ((shininess + 2) / 8), .shininess = shininess};
}
const std::vector<Material> surfaces{
    shiny("gold", {0, 0, 0}, {1, 0.75, 0.25}, 30), shiny("plastic", {0.5, 0.25, 0}, {0.04, 0.04, 0.04}, 14),
    shiny("silk", {0.25, 0.5, 0.125}, {0.25, 0.125, 0.5}, 62), shiny("chalk", {0.75, 0.5, 1}, {0, 0, 0}, 30),
    shiny("soot", {0, 0, 0}, {0, 0, 0}, 30)};

TEST_P(RoundTrip, MetalsComeBack) {
  const Mesh back = there_and_back(strip(surfaces));
  EXPECT_THAT(warnings_, ElementsAre());
  for (std::size_t i = 0; i < surfaces.size(); ++i) expect_same(surfaces[i], back.materials->materials.at(i));
}

// Without "extras": the numbers that every program reads.
TEST(GltfMaterials, OfOtherProgramsAreTheSameSurfaces) {
  const test::TempFolder folder;
  const FilePath file{"m.gltf", folder.file("m.gltf")};
  Context ctx;
  save_buffer_file(Ref<Mesh>(test::shared(strip(surfaces))), {.path = file.resolved}, ctx);
  auto json = nlohmann::json::parse(FileBytes(file).text());
  const auto& gold = json["materials"][0]["pbrMetallicRoughness"];
  EXPECT_EQ(gold["metallicFactor"], 1);
  EXPECT_EQ(gold["baseColorFactor"], (nlohmann::json{1, 0.75, 0.25, 1}));
  EXPECT_EQ(gold["roughnessFactor"], 0.5) << "alpha = 1/4, 2 / alpha^2 - 2 = 30";
  EXPECT_FALSE(json["materials"][1].contains("extensions")) << "0.04 is what glTF has";
  for (auto& material : json["materials"]) material.erase("extras");
  const Mesh back = read_gltf(json.dump(), file, true, ctx).mesh;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const Material &from = surfaces[i], &to = back.materials->materials.at(i);
    SCOPED_TRACE(from.name);
    expect_same(from.diffuse, to.diffuse, 1e-15);
    expect_same(from.specular, to.specular, 1e-14);
    EXPECT_EQ(from.shininess, to.shininess);
  }
}

TEST_P(RoundTrip, ColumnsOfOtherNamesComeBack) {
  Mesh mesh = test::mesh_of<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, Space::world);
  const std::vector<glm::vec3> normal(3, glm::vec3(0, 0, 1)), flow{{1, 2, 3}, {4, 5, 6}, {7, 8, -9}};
  const std::vector<float> quality{0.25F, 0.5F, 1};
  mesh.columns.push_back(Column::make<glm::vec3>("normal", Domain::vertex, normal));
  mesh.columns.push_back(Column::make<float>("quality", Domain::vertex, quality));
  mesh.columns.push_back(Column::make<glm::vec3>("flow_2", Domain::vertex, flow));
  mesh.columns.push_back(Column::make<float>("w", Domain::vertex, quality));
  mesh.columns.push_back(Column::make<float>("Heat", Domain::vertex, quality));
  mesh.columns.push_back(Column::make<float>("HEAT", Domain::vertex, quality));
  const Mesh back = there_and_back(mesh);
  EXPECT_EQ(test::column<float>(back, "quality"), quality);
  EXPECT_EQ(test::column<glm::vec3>(back, "flow_2"), flow);
  EXPECT_EQ(test::column<float>(back, "gltf_w"), quality);
  EXPECT_EQ(test::column<float>(back, "heat"), quality);
  EXPECT_THAT(warnings_, ElementsAre("glTF has no place for the name of column 'w', which is _W there",
                                     "glTF has no place for the name of column 'Heat', which is _HEAT there",
                                     "glTF has no place for column 'HEAT'"));
}

TEST(GltfAttributes, OfApplicationsAreColumns) {
  test::GltfMaker g = test::one_triangle();
  const std::size_t other = g.accessor<float>({0, 0, 1, 1, 0, 1, 0, 1, 1}, "VEC3"),
                    heat = g.accessor<std::uint8_t>({0, 255, 51}, "SCALAR", true),
                    flow = g.accessor<float>({1, 2, 3, 4, 5, 6}, "VEC2"),
                    ids = g.accessor<std::uint32_t>({7, 8, 9}, "SCALAR"),
                    short_one = g.accessor<float>({1, 2}, "SCALAR");
  auto& primitives = g.document["meshes"][0]["primitives"];
  primitives.push_back({{"attributes", {{"POSITION", other}, {"_HEAT", flow}}}});
  auto& attributes = primitives[0]["attributes"];
  attributes["_HEAT"] = heat, attributes["_FLOW"] = flow, attributes["_ID"] = heat, attributes["_WHO"] = ids;
  g.document["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "MAT2"}});
  attributes["_TURN"] = g.document["accessors"].size() - 1;
  Context ctx;
  const Mesh m = read_gltf(g.glb(), test::box, true, ctx).mesh;
  EXPECT_EQ(m.validate(), "");
  EXPECT_THAT(test::column<float>(m, "heat"), ElementsAre(0, 1, 0.2F, 0, 0, 0));
  EXPECT_THAT(test::column<glm::vec2>(m, "flow"),
              ElementsAre(glm::vec2(1, 2), glm::vec2(3, 4), glm::vec2(5, 6), glm::vec2(0), glm::vec2(0),
                          glm::vec2(0)));
  EXPECT_THAT(test::column<float>(m, "gltf_id"), ElementsAre(0, 1, 0.2F, 0, 0, 0));
  std::string said;
  for (const auto& [code, what] : ctx.warnings()) said += what + "\n";
  for (const char* part : {"the attribute _WHO, which is left out", "the attribute _TURN, which is left out",
                           "primitives[1] has 2 numbers of 'heat' a vertex, and others 1: they are left out"})
    EXPECT_THAT(said, testing::HasSubstr(part));
  attributes["_HEAT"] = short_one;
  EXPECT_THAT(test::gltf_problem(g.glb()).second, testing::HasSubstr("has 2 elements, and POSITION 3"));
}

TEST_P(RoundTrip, LightThatNoSurfaceSendsBackIsTold) {
  const std::vector<Material> bright{Material{.name = "white", .diffuse{1, 1.5, 1}},
                                     shiny("mirror", {0, 0, 0}, {1, 1, 1.25}, 30),
                                     shiny("both", {0.75, 0.5, 0.5}, {0.5, 0.25, 0.25}, 30),
                                     shiny("within", {0.5, 0.5, 0.5}, {0.5, 0, 0}, 30)};
  const Mesh back = there_and_back(strip(bright));
  std::vector<std::string> told;
  for (const char* name : {"white", "mirror", "both"})
    told.push_back(fmt::format(
        "glTF has no place for the light that material '{}' sends back beyond what falls on it", name));
  EXPECT_EQ(warnings_, told);
  for (std::size_t i = 0; i < bright.size(); ++i) expect_same(bright[i], back.materials->materials.at(i));
}

TEST_P(RoundTrip, OpacityComesBack) {
  Mesh mesh = strip({Material{.name = "wood"}, Material{.name = "glass"},
                     Material{.name = "veil", .texture = picture(4, 4, false)}});
  const std::vector<float> clear{0, 0.75F, 0};
  mesh.columns.push_back(Column::make<float>("transparency", Domain::face, clear));
  const Mesh back = there_and_back(mesh);
  EXPECT_THAT(warnings_, ElementsAre());
  EXPECT_EQ(test::column<float>(back, "transparency"), clear);
  expect_same(mesh.materials->materials[2], back.materials->materials[2]);
}

TEST_P(RoundTrip, VerticesThatAreSeenThroughGetAMaterialThatSaysSo) {
  Mesh mesh = test::mesh_of<glm::vec3>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, Space::world);
  const std::vector<glm::vec4> color{{1, 0, 0, 0.5}, {1, 1, 0, 0.25}, {1, 1, 1, 1}};
  mesh.columns.push_back(Column::make<glm::vec4>("color", Domain::vertex, color));
  const std::vector<glm::vec3> normal(3, glm::vec3(0, 0, 1));
  mesh.columns.push_back(Column::make<glm::vec3>("normal", Domain::vertex, normal));
  EXPECT_EQ(test::column<glm::vec4>(there_and_back(mesh), "color"), color);
}

TEST_P(RoundTrip, WhatGltfHasNoPlaceForIsNamed) {
  Material shear{.name = "sheared", .texture = picture(2, 2, true)};
  shear.texture_from_uv[1] = {0.5, 1, 0};
  Mesh mesh = strip({shear, Material{.name = "board", .texture = std::make_shared<const Texture>(Checker{})},
                     Material{.name = "mixed"}});
  there_and_back(mesh);
  EXPECT_THAT(warnings_, ElementsAre("glTF has no place for the shear of the texture of material 'sheared'",
                                     "glTF has no place for the checkerboard of material 'board'"));
}

INSTANTIATE_TEST_SUITE_P(Forms, RoundTrip, testing::Values("glb", "gltf"),
                         [](const auto& form) { return std::string(form.param); });

TEST(TexturePng, TakesSixteenBitsWhereEightDoNotDo) {
  MipPyramid p;
  p.levels.push_back({1, 1, {0.2F, 0.5F, 0.7F, 1}});
  const TexturePng fine = texture_png(p, "t");
  EXPECT_EQ(fine.bytes[24], 16) << "bit depth in IHDR";
  EXPECT_FALSE(fine.clipped);
  p.levels[0].rgba = {1, 0, 1, 1};
  EXPECT_EQ(texture_png(p, "t").bytes[24], 8);
  p.levels[0].rgba = {2, 0, 1, 1};
  EXPECT_TRUE(texture_png(p, "t").clipped);
}

}  // namespace
}  // namespace frustum
