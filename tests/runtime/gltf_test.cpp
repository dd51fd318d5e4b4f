// Meshes, materials, cameras and lights of glTF files.
#include "runtime/io/gltf.h"

#include "runtime/buffers/texture.h"
#include "runtime/core/error.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/gltf_problem.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace frustum {
namespace {

using test::box;
using test::GltfMaker;
using testing::ElementsAre;
using testing::HasSubstr;
using Tree = nlohmann::json;

GltfScene read(const std::string& bytes, Context& ctx, const FilePath& file = box) {
  GltfScene s = read_gltf(bytes, file, true, ctx);
  EXPECT_EQ(s.mesh.validate(), "");
  return s;
}
GltfScene read(const std::string& bytes) {
  Context ctx;
  return read(bytes, ctx);
}
std::vector<glm::vec3> column3(const Mesh& m, std::string_view name) {
  const auto v = m.at(name).values<glm::vec3>();
  return {v.begin(), v.end()};
}
std::vector<glm::uvec3> faces(const Mesh& m) { return {m.triangles().begin(), m.triangles().end()}; }
std::string warnings(const Context& ctx) {
  std::string all;
  for (const auto& [code, text] : ctx.warnings()) all += code + ": " + text + "\n";
  return all;
}

TEST(Gltf, AHandMadeTriangleIsReadAsItIs) {
  Context ctx;
  const Mesh m = read(test::one_triangle().glb(), ctx).mesh;
  EXPECT_EQ(column3(m, "position"), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(faces(m), (std::vector<glm::uvec3>{{0, 1, 2}}));
  EXPECT_EQ(column3(m, "normal"), std::vector<glm::vec3>(3, {0, 0, 1})) << "of the face";
  EXPECT_EQ(m.at("normal").domain(), Domain::corner);
  EXPECT_EQ(m.space(), Space::world);
  EXPECT_EQ(m.materials, nullptr);
  EXPECT_THAT(warnings(ctx), HasSubstr("normals_computed: box.glb: 1 triangles have no normals"));
}

TEST(Gltf, TextAndBufferBesideOrInTheUriAreTheSameAsGlb) {
  const GltfMaker g = test::one_triangle();
  test::TempFolder folder;
  folder.write("a b.bin", g.binary());
  Tree document = g.document;
  document["buffers"] = {{{"uri", "a%20b.bin"}, {"byteLength", g.binary().size()}}};
  Context ctx;
  const FilePath file{"m.gltf", folder.file("m.gltf")};
  const Mesh beside = read(document.dump(), ctx, file).mesh;
  // 36 bytes of floats: 0 0 0, 1 0 0, 0 1 0.
  document["buffers"][0]["uri"] =
      "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  const Mesh inside = read(document.dump(), ctx, file).mesh;
  const auto digest = [](const Mesh& m) { return Buffer(std::make_shared<const Mesh>(m)).digest(); };
  EXPECT_EQ(digest(beside), digest(inside));
  EXPECT_EQ(digest(beside), digest(read(g.glb()).mesh));
}

template <class T>
std::vector<glm::uvec3> faces_of_mode(int mode, const std::vector<T>& index) {
  GltfMaker g;
  const std::size_t position = g.accessor(std::vector<float>(18, 0.5F), "VEC3");
  Tree primitive = {{"attributes", {{"POSITION", position}}}, {"mode", mode}};
  if (!index.empty()) primitive["indices"] = g.accessor(index, "SCALAR");
  g.node({{"mesh", g.mesh(primitive)}});
  return faces(read(g.glb()).mesh);
}

TEST(Gltf, ListsStripsAndFansOfEveryIndexTypeBecomeTriangles) {
  const std::vector<glm::uvec3> list = {{5, 4, 3}, {0, 1, 2}};
  EXPECT_EQ(faces_of_mode<std::uint8_t>(4, {5, 4, 3, 0, 1, 2}), list);
  EXPECT_EQ(faces_of_mode<std::uint16_t>(4, {5, 4, 3, 0, 1, 2}), list);
  EXPECT_EQ(faces_of_mode<std::uint32_t>(4, {5, 4, 3, 0, 1, 2}), list);
  EXPECT_EQ(faces_of_mode<std::uint8_t>(4, {}), (std::vector<glm::uvec3>{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(faces_of_mode<std::uint8_t>(5, {0, 1, 2, 3, 4}),
            (std::vector<glm::uvec3>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(faces_of_mode<std::uint16_t>(6, {0, 1, 2, 3}), (std::vector<glm::uvec3>{{1, 2, 0}, {2, 3, 0}}));
  EXPECT_EQ(faces_of_mode<std::uint16_t>(6, {0, 1}), std::vector<glm::uvec3>{});
  EXPECT_EQ(faces_of_mode<std::uint16_t>(0, {0, 1}), std::vector<glm::uvec3>{}) << "points are left out";
}

TEST(Gltf, StridesNormalisedIntegersAndSparseElementsGiveTheirValues) {
  GltfMaker g;
  // Position and uv interleaved, 20 bytes apart.
  std::string rows;
  for (int i = 0; i < 3; ++i) {
    const std::vector<float> p = {static_cast<float>(i), 2, 3};
    const std::vector<std::uint16_t> uv = {0, static_cast<std::uint16_t>(i * 32767), 7, 7};
    rows += GltfMaker::bytes_of(p) + GltfMaker::bytes_of(uv);
  }
  const std::size_t view = g.view(rows, 20);
  g.document["accessors"] = {{{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
                             {{"bufferView", view},
                              {"byteOffset", 12},
                              {"componentType", 5123},
                              {"count", 3},
                              {"type", "VEC2"},
                              {"normalized", true}}};
  g.document["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", g.view(GltfMaker::bytes_of<std::uint8_t>({1}))}, {"componentType", 5121}}},
      {"values", {{"bufferView", g.view(GltfMaker::bytes_of<float>({-1, -2, -3}))}}}};
  const std::size_t color =
      g.accessor<std::uint8_t>({255, 0, 51, 102, 0, 0, 0, 255, 255, 255, 255, 0}, "VEC4", true);
  g.node({{"mesh", g.mesh({{"attributes",
                            {{"POSITION", 0}, {"TEXCOORD_0", 1}, {"TEXCOORD_3", 1}, {"COLOR_0", color}}}})}});
  EXPECT_EQ(column3(read(g.glb()).mesh, "color")[0], glm::vec3(1, 0, 0.2F)) << "nothing blends";
  g.document["materials"] = {{{"alphaMode", "BLEND"}}};
  g.document["meshes"][0]["primitives"][0]["material"] = 0;
  const Mesh m = read(g.glb()).mesh;
  EXPECT_EQ(column3(m, "position"), (std::vector<glm::vec3>{{0, 2, 3}, {-1, -2, -3}, {2, 2, 3}}));
  const auto uv = m.at("uv").values<glm::vec2>();
  EXPECT_EQ(uv[0], glm::vec2(0, 1)) << "v points up here";
  EXPECT_FLOAT_EQ(uv[2].y, 1 - 65534.0F / 65535);
  EXPECT_EQ(m.at("uv3").values<glm::vec2>()[0], uv[0]);
  EXPECT_EQ(m.at("color").values<glm::vec4>()[0], glm::vec4(1, 0, 0.2F, 0.4F));
}

TEST(Gltf, QuantisedPositionsAreReadWhereTheFileSaysSo) {
  GltfMaker g;
  const std::size_t p = g.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 0, -128, 0}, "VEC3", true);
  g.document["accessors"][p]["bufferView"] = g.view({"\0\0\0\0\x7F\0\0\0\0\x80\0\0", 12}, 4);
  g.node({{"mesh", g.mesh({{"attributes", {{"POSITION", p}}}})}});
  EXPECT_THAT(test::gltf_problem(g.glb()).second, HasSubstr("accessors[0] must be VEC3 of floats"));
  g.document["extensionsUsed"] = {"KHR_mesh_quantization"};
  g.document["extensionsRequired"] = {"KHR_mesh_quantization"};
  EXPECT_EQ(column3(read(g.glb()).mesh, "position"),
            (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}));
}

TEST(Gltf, InstancesStandInTheirPlacesAndMirroredOnesAreTurned) {
  GltfMaker g;
  const std::size_t p = g.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t n = g.accessor<float>({0, 0, 1, 0, 0, 1, 0.6F, 0, 0.8F}, "VEC3");
  const std::size_t mesh = g.mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}}}});
  const double h = std::sqrt(0.5);
  const std::size_t child = g.node({{"mesh", mesh}, {"translation", {0, 0, 5}}}, false);
  g.node({{"mesh", mesh}, {"rotation", {h, 0, 0, h}}, {"children", {child}}});  // a quarter turn about x
  g.node({{"mesh", mesh}, {"scale", {-2, 1, 1}}});
  g.node({{"mesh", mesh}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}});
  const Mesh m = read(g.glb()).mesh;
  const auto position = column3(m, "position"), normal = column3(m, "normal");
  ASSERT_EQ(position.size(), 12u);
  EXPECT_EQ(position[2], glm::vec3(0, 0, 1)) << "exact: y became z";
  EXPECT_EQ(position[5], glm::vec3(0, -5, 1)) << "the child";
  EXPECT_EQ(position[7], glm::vec3(-2, 0, 0));
  EXPECT_EQ(position[11], glm::vec3(7, 9, 9));
  EXPECT_THAT(faces(m), ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(3, 4, 5), glm::uvec3(6, 8, 7),
                                    glm::uvec3(9, 10, 11)));
  EXPECT_EQ(normal[0], glm::vec3(0, -1, 0));
  EXPECT_EQ(normal[6], glm::vec3(0, 0, 1)) << "a mirror keeps the side";
  // (0.6, 0, 0.8) under a scale of (-2, 1, 1): along (-0.3, 0, 0.8).
  EXPECT_NEAR(normal[8].x / normal[8].z, -0.375F, 1e-6F);
  EXPECT_EQ(normal[11], glm::vec3(0.6F, 0, 0.8F)) << "bit for bit where nothing turns";
  EXPECT_EQ(m.at("normal").domain(), Domain::vertex);
}

TEST(Gltf, NormalsWithoutLengthAreMended) {
  GltfMaker g;
  const std::size_t p = g.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const std::size_t n = g.accessor<float>({0, 0, 0, 0, 3, 4, NAN, 0, 0}, "VEC3");
  g.node({{"mesh", g.mesh({{"attributes", {{"POSITION", p}, {"NORMAL", n}}}})}});
  Context ctx;
  const auto normal = column3(read(g.glb(), ctx).mesh, "normal");
  EXPECT_EQ(normal[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(normal[1], glm::vec3(0, 0.6F, 0.8F));
  EXPECT_EQ(normal[2], glm::vec3(0, 0, 1));
  EXPECT_THAT(warnings(ctx), HasSubstr("2 normals have no length"));
}

// Four corners of a square, of two triangles in primitives of their own; none of the normals has a length.
GltfMaker halves() {
  GltfMaker g;
  const std::size_t p = g.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 1}, "VEC3");
  const std::size_t n = g.accessor<float>(std::vector<float>(12, 0.0F), "VEC3");
  const std::size_t c = g.accessor<std::uint8_t>(std::vector<std::uint8_t>(16, 51), "VEC4", true);
  const auto primitive = [&](const std::vector<std::uint8_t>& corners, int material) {
    return Tree{{"attributes", {{"POSITION", p}, {"NORMAL", n}, {"COLOR_0", c}}},
                {"indices", g.accessor<std::uint8_t>(corners, "SCALAR")},
                {"material", material}};
  };
  g.document["materials"] = {{{"name", "a"}}, {{"name", "b"}}};
  g.node({{"mesh", g.mesh(primitive({0, 1, 2}, 0))}});
  g.document["meshes"][0]["primitives"].push_back(primitive({0, 2, 3}, 1));
  return g;
}

TEST(Gltf, PrimitivesOfTheSameAccessorsShareTheirVertices) {
  GltfMaker g = halves();
  const Mesh m = read(g.glb()).mesh;
  EXPECT_EQ(m.vertices(), 4u);
  EXPECT_EQ(faces(m), (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_THAT(m.at("material").values<std::uint32_t>(), ElementsAre(0u, 1u));
  // Corner 0 is of both: the mean of (0, 0, 1) and of the second's cross product (1, -1, 1).
  EXPECT_NEAR(glm::distance(column3(m, "normal")[0], glm::vec3(1, -1, 2) / std::sqrt(6.0F)), 0, 1e-6);

  g.node({{"mesh", 0}, {"translation", {1, 0, 0}}});
  const Mesh twice = read(g.glb()).mesh;
  EXPECT_EQ(faces(twice), (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}}));
  EXPECT_EQ(column3(twice, "position")[7], glm::vec3(1, 1, 1));
}

TEST(Gltf, PrimitivesWhoseOpacityIsReadDifferentlyDoNotShareVertices) {
  GltfMaker g = halves();
  g.document["materials"][1]["alphaMode"] = "BLEND";
  const Mesh m = read(g.glb()).mesh;
  EXPECT_EQ(m.vertices(), 8u);
  const auto color = m.at("color").values<glm::vec4>();
  EXPECT_EQ(color[0].a, 1);
  EXPECT_FLOAT_EQ(color[4].a, 0.2F);
}

// ----- materials

Material material_of(Tree material, std::string* said = nullptr) {
  GltfMaker g = test::one_triangle();
  g.document["materials"] = Tree::array({std::move(material)});
  g.document["meshes"][0]["primitives"][0]["material"] = 0;
  Context ctx;
  const Mesh m = read(g.glb(), ctx).mesh;
  if (said != nullptr) *said = warnings(ctx);
  return m.materials->materials.at(0);
}

TEST(Gltf, AMaterialKeepsItsReflectance) {
  const Material clay = material_of(
      {{"name", "clay"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 1, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}}}});
  EXPECT_EQ(clay.name, "clay");
  EXPECT_NEAR(clay.diffuse.r, 0.5 * 0.96, 1e-12);
  EXPECT_EQ(clay.shininess, 30) << "alpha = 1/4, 2 / alpha^2 - 2";
  EXPECT_NEAR(clay.specular.r, 0.04 * 32 / 8, 1e-12);
  const Material brass = material_of(
      {{"pbrMetallicRoughness", {{"baseColorFactor", {0.9, 0.7, 0.3, 1}}, {"roughnessFactor", 0.5}}}});
  EXPECT_EQ(brass.diffuse, glm::dvec3(0)) << "metal unless said otherwise";
  EXPECT_NEAR(brass.specular.b, 0.3 * 32 / 8, 1e-12);
  const Tree tinted = {{"specularFactor", 0.5}, {"specularColorFactor", {2, 1, 100}}};
  const Material satin =
      material_of({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.5}}},
                   {"extensions", {{"KHR_materials_specular", tinted}}}});
  EXPECT_NEAR(satin.specular.r, 0.04 * 32 / 8, 1e-12);
  EXPECT_NEAR(satin.specular.g, 0.02 * 32 / 8, 1e-12);
  EXPECT_NEAR(satin.specular.b, 0.5 * 32 / 8, 1e-12) << "at most 1, then by the factor";
  EXPECT_NEAR(satin.diffuse.r, 0.5, 1e-12);
  for (const double roughness : {0.0, 0.1, 0.3, 0.7, 1.0})
    for (const double metallic : {0.0, 0.5, 1.0}) {
      const Material m = material_of(
          {{"pbrMetallicRoughness", {{"metallicFactor", metallic}, {"roughnessFactor", roughness}}}});
      const double n = m.shininess, lobe = 8 * (n + std::exp2(-n / 2)) / ((n + 2) * (n + 4));
      EXPECT_LE(m.diffuse.r + m.specular.r * lobe, 1 + 1e-12) << roughness << " " << metallic;
    }
}

TEST(Gltf, AnEmptyFileIsSaidToBeEmpty) {
  EXPECT_EQ(test::gltf_problem("").second, "box.glb: there is nothing in it, and glTF is JSON");
}

TEST(Gltf, MetalsOfEitherModelAreTold) {
  const auto told = [](const Tree& model) {
    std::string said;
    material_of({{"extensions", {{"KHR_materials_pbrSpecularGlossiness", model}}}}, &said);
    return said;
  };
  const auto metal = HasSubstr("materials[0] is metal, which shows highlights but mirrors no surroundings");
  EXPECT_THAT(told(Tree::object()), metal) << "specular [1, 1, 1] unless said otherwise: diffuse 0";
  EXPECT_THAT(told({{"specularFactor", {0.9, 0.6, 0.2}}}), metal);
  EXPECT_THAT(told({{"specularFactor", {0.04, 0.04, 0.04}}}), testing::Not(HasSubstr("metal")));
}

TEST(Gltf, WhatDoesNotMapIsSaidOnceAKind) {
  std::string said;
  const Material m = material_of({{"doubleSided", true},
                                  {"alphaCutoff", 0.5},
                                  {"emissiveFactor", {0.5, 0, 0}},
                                  {"pbrMetallicRoughness", {{"metallicFactor", 0}}},
                                  {"normalTexture", {{"index", 0}}},
                                  {"extensions",
                                   {{"KHR_materials_clearcoat", Tree::object()},
                                    {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}},
                                 &said);
  EXPECT_TRUE(m.two_sided);
  EXPECT_EQ(m.emission, glm::dvec3(2, 0, 0));
  for (const char* part :
       {"materials[0] has an alphaCutoff without alphaMode MASK: it counts for nothing",
        "has a normal texture, which is left out", "has KHR_materials_clearcoat, which is left out"})
    EXPECT_THAT(said, HasSubstr(part));
  EXPECT_THAT(said, testing::Not(HasSubstr("emissive_strength")));
}

GltfMaker textured() {
  GltfMaker g;
  const std::size_t p = g.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3"),
                    uv = g.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2");
  g.document["materials"] = {
      {{"name", "card"},
       {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicFactor", 0}}}}};
  g.document["textures"] = {{{"source", 0}, {"sampler", 0}}};
  g.document["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  g.document["images"] = {{{"uri", "card.png"}}};
  g.node({{"mesh", g.mesh({{"attributes", {{"POSITION", p}, {"TEXCOORD_0", uv}}}, {"material", 0}})}});
  return g;
}

TEST(Gltf, MaterialsWithoutANameAreToldByTheirNumber) {
  test::TempFolder folder;
  std::filesystem::copy_file(std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data/card.png",
                             folder.file("card.png"));
  GltfMaker g = textured();
  g.document["materials"][0].erase("name");
  g.document["meshes"][0]["primitives"][0]["attributes"].erase("TEXCOORD_0");
  Context ctx;
  EXPECT_EQ(read(g.glb(), ctx, {"m.glb", folder.file("m.glb")}).mesh.materials->materials.at(0).texture,
            nullptr);
  EXPECT_THAT(warnings(ctx), HasSubstr("materials[0] has a texture, and no face texture coordinates for it"));
}

TEST(Gltf, TexturesAreReadFromBesideAndFromInside) {
  test::TempFolder folder;
  std::filesystem::copy_file(std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data/card.png",
                             folder.file("card.png"));
  GltfMaker g = textured();
  Context ctx;
  const FilePath file{"m.glb", folder.file("m.glb")};
  const Mesh m = read(g.glb(), ctx, file).mesh;
  const auto& pyramid = std::get<MipPyramid>(m.materials->materials.at(0).texture->source);
  EXPECT_EQ(pyramid.levels.at(0).width, 96);
  EXPECT_EQ(pyramid.wrap_u, Wrap::clamp);
  EXPECT_EQ(pyramid.wrap_v, Wrap::mirror);
  for (std::size_t i = 3; i < pyramid.levels[0].rgba.size(); i += 4)
    ASSERT_EQ(pyramid.levels[0].rgba[i], 1.0F);

  std::ifstream in(folder.file("card.png"), std::ios::binary);
  const std::string png((std::istreambuf_iterator<char>(in)), {});
  GltfMaker inside = textured();
  inside.document["images"] = {{{"bufferView", inside.view(png)}, {"mimeType", "image/png"}}};
  const Mesh same = read(inside.glb(), ctx, file).mesh;
  EXPECT_EQ(same.materials->materials[0].texture->digest(), m.materials->materials[0].texture->digest());

  GltfMaker cut = textured();
  cut.document["images"] = {
      {{"bufferView", cut.view(png.substr(0, png.size() / 2))}, {"mimeType", "image/png"}}};
  EXPECT_EQ(test::gltf_problem(cut.glb(), file).first, "malformed_file");
  EXPECT_THAT(test::gltf_problem(cut.glb(), file).second, HasSubstr("m.glb: images[0]: it is cut off after"));
}

TEST(Gltf, AMovedTextureMovesInOurCoordinates) {
  test::TempFolder folder;
  std::filesystem::copy_file(std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data/card.png",
                             folder.file("card.png"));
  GltfMaker g = textured();
  auto& info = g.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  // The example of the extension's text: the lower left quadrant of the picture, turned by a right angle.
  info["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 1}}, {"rotation", std::numbers::pi / 2}, {"scale", {0.5, 0.5}}};
  Context ctx;
  const Material m = read(g.glb(), ctx, {"m.glb", folder.file("m.glb")}).mesh.materials->materials.at(0);
  // In coordinates with v down, as the file has them.
  const auto moved = [&](double u, double v_down) {
    const glm::dvec3 here = m.texture_from_uv * glm::dvec3(u, 1 - v_down, 1);
    return glm::dvec2(here.x, 1 - here.y);
  };
  const std::pair<glm::dvec2, glm::dvec2> corners[] = {
      {{0, 0}, {0, 1}}, {{1, 0}, {0, 0.5}}, {{1, 1}, {0.5, 0.5}}, {{0, 1}, {0.5, 1}}};
  for (const auto& [from, to] : corners) {
    EXPECT_NEAR(moved(from.x, from.y).x, to.x, 1e-12);
    EXPECT_NEAR(moved(from.x, from.y).y, to.y, 1e-12);
  }
}

// ----- cameras and lights

TEST(Gltf, CamerasAndLightsStandWhereTheirNodesDo) {
  GltfMaker g = test::one_triangle();
  g.document["cameras"] = {
      {{"type", "perspective"}, {"name", "c"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}}};
  g.document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", std::numbers::pi}},
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 2 * std::numbers::pi}}};
  const double h = std::sqrt(0.5);
  g.node({{"camera", 0}, {"name", "front"}, {"translation", {1, 2, 3}}, {"rotation", {0, h, 0, h}}});
  g.node({{"rotation", {-h, 0, 0, h}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  g.node({{"translation", {0, 4, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  const GltfScene s = read(g.glb());
  ASSERT_EQ(s.views.size(), 1u);
  EXPECT_EQ(s.views[0].node, "front");
  EXPECT_EQ(s.views[0].camera.eye, glm::dvec3(1, 2, 3));
  EXPECT_EQ(s.views[0].camera.target, glm::dvec3(0, 2, 3)) << "a quarter turn about y looks along -x";
  EXPECT_EQ(s.views[0].camera.fov_y, 0.5);
  EXPECT_TRUE(std::isinf(s.views[0].camera.far_z));
  ASSERT_EQ(s.lights.lights.size(), 2u);
  EXPECT_EQ(s.lights.lights[0].direction, glm::dvec3(0, -1, 0)) << "turned from -z to down";
  EXPECT_NEAR(s.lights.lights[0].color.r, 1, 1e-15) << "pi lux make a white surface 1 bright";
  EXPECT_EQ(s.lights.lights[1].position, glm::dvec3(0, 4, 0));
  EXPECT_EQ(s.lights.lights[1].attenuation, glm::dvec3(0, 0, 1));
  EXPECT_NEAR(s.lights.lights[1].color.g, 1, 1e-15);
}

TEST(Gltf, ASpotKeepsItsCone) {
  const auto lights = [](const nlohmann::json& spot) {
    GltfMaker g = test::one_triangle();
    g.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"spot", spot}}};
    g.node({{"translation", {0, 4, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return g.glb();
  };
  const Light whole = read(lights({{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}})).lights.lights.at(0);
  EXPECT_EQ(whole.kind, Light::Kind::spot);
  EXPECT_EQ(whole.position, glm::dvec3(0, 4, 0));
  EXPECT_EQ(whole.direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(whole.inner, 0.25);
  EXPECT_EQ(whole.outer, 0.5);
  const Light usual = read(lights(nlohmann::json::object())).lights.lights.at(0);
  EXPECT_EQ(usual.inner, 0);
  EXPECT_DOUBLE_EQ(usual.outer, std::numbers::pi / 4);
  EXPECT_EQ(test::gltf_problem(lights({{"innerConeAngle", 0.5}, {"outerConeAngle", 0.25}})).first,
            "malformed_file");
  EXPECT_EQ(test::gltf_problem(lights({{"outerConeAngle", 2}})).first, "malformed_file");
}

// ----- files without an end

TEST(Gltf, AFileCutOffAnywhereIsAProblemAndNotACrash) {
  const std::string whole = textured().glb();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto [code, message] = test::gltf_problem(whole.substr(0, n));
    EXPECT_TRUE(code == "malformed_file" || code == "unsupported_version")
        << n << " " << code << " " << message;
  }
  std::string text = test::one_triangle().document.dump();
  EXPECT_THAT(test::gltf_problem(text.substr(0, 20)).second, HasSubstr("box.glb:1:"));
}

TEST(Gltf, ANumberBeyondAllIsSaidInPlainWords) {
  std::string text = test::one_triangle().document.dump();
  text.insert(1, R"("extras": 1e400, )");
  EXPECT_EQ(test::gltf_problem(text),
            (std::pair<std::string, std::string>("malformed_file",
                                                 "box.glb: a number is beyond the largest one, 1.8e308")));
}

TEST(Gltf, DeepTreesOfNodesAndOfJsonDoNotUseUpTheStack) {
  GltfMaker g = test::one_triangle();
  constexpr int depth = 100000;
  Tree nodes = Tree::array();
  for (int i = 0; i < depth; ++i) nodes.push_back({{"children", {i + 1}}, {"translation", {0, 0, 1}}});
  nodes.push_back({{"mesh", 0}});
  g.document["nodes"] = std::move(nodes);
  EXPECT_EQ(column3(read(g.glb()).mesh, "position")[0], glm::vec3(0, 0, depth));
  std::string deep = R"({"asset":{"version":"2.0"},"extras":)";
  for (int i = 0; i < depth; ++i) deep += '[';
  for (int i = 0; i < depth; ++i) deep += ']';
  EXPECT_EQ(read(deep + "}").mesh.faces(), 0u);
}

TEST(Gltf, DoubleKeepsWhatSingleRounds) {
  GltfMaker g = test::one_triangle();
  g.document["nodes"][0]["translation"] = {0.1, 0, 0};
  Context ctx;
  ctx.precision = Precision::real_double;
  EXPECT_EQ(read(g.glb(), ctx).mesh.at("position").values<glm::dvec3>()[0].x, 0.1);
}

}  // namespace
}  // namespace frustum
