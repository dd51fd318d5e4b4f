#include "runtime/io/mtl.h"

#include "nodes/kernels/transfer.h"
#include "runtime/buffers/texture.h"
#include "runtime/io/image_files.h"
#include "runtime/io/obj.h"
#include "tests/support/mesh_text.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <set>

namespace frustum {
namespace {

using test::values;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";

// A folder with an OBJ file in it, and what reading that gives.
class Obj : public testing::Test {
 protected:
  Mesh read(const std::string& text) {
    warnings.clear(), messages.clear();
    Context ctx;
    const Mesh m = read_obj(text, path(), ctx);
    for (const auto& [code, message] : ctx.warnings()) warnings.push_back(code), messages += message + "\n";
    EXPECT_EQ(m.validate(), "");
    return m;
  }
  Mesh read_mtl(const std::string& mtl) {
    folder.write("a.mtl", mtl);
    return read("mtllib a.mtl\n" + triangle + "usemtl one\nf 1/1/1 2/1/1 3/1/1\n");
  }
  const Material& material(const std::string& mtl) {
    return (mesh = read_mtl(mtl)).materials->materials.at(0);
  }
  std::string problem(const std::string& mtl) {
    try {
      read_mtl(mtl);
    } catch (const NodeError& e) {
      EXPECT_EQ(e.code, "malformed_file");
      return e.what();
    }
    return "";
  }
  FilePath path() const { return {"m.obj", folder.file("m.obj")}; }
  // A picture of two texels, red and blue.
  void write_picture(const std::string& name) {
    Frame frame;
    frame.window = {0, 0, 2, 1};
    frame.planes = {{"R", PlaneKind::f32}, {"G", PlaneKind::f32}, {"B", PlaneKind::f32}};
    frame.color_space = "srgb";
    const Raster raster(frame);
    for (int p = 0; p < 3; ++p)
      for (int x = 0; x < 2; ++x) raster.view().row<float>(p, 0, 0)[x] = p == 2 * x ? 1.0f : 0.0f;
    const auto sink = open_image_sink({.path = folder.file(name),
                                       .region = frame.window,
                                       .display_window = frame.window,
                                       .layers = {{"", frame}},
                                       .compression = {},
                                       .metadata = {}});
    const Tile all = raster.view();
    sink->write({&all, 1});
    sink->finish();
  }

  test::TempFolder folder;
  Mesh mesh;
  std::vector<std::string> warnings;
  std::string messages;
};

TEST_F(Obj, MaterialsHaveTheValuesOfTheirFile) {
  const Material& m = material(
      "# made by hand\r\nnewmtl other\nKd 0 0 0\nnewmtl one\n\tKa 0.1 0.2 0.3\n  Kd 0.5 0.25 0\nKs 0.5\nNs "
      "96.5\nKe 1 2 3\nillum 2\nNi 1.45\nd 1.0\n");
  EXPECT_EQ(m.name, "one");
  EXPECT_EQ(m.diffuse, glm::dvec3(0.5, 0.25, 0));
  EXPECT_EQ(m.ambient, glm::dvec3(0.1 / 0.5, 0.2 / 0.25, 1));
  EXPECT_EQ(m.specular, glm::dvec3(0.5));
  EXPECT_EQ(m.emission, glm::dvec3(1, 2, 3));
  EXPECT_EQ(m.shininess, 96.5);
  EXPECT_EQ(m.texture, nullptr);
  EXPECT_THAT(warnings, ElementsAre("statements_skipped"));
  EXPECT_EQ(messages, "a.mtl: skipped 1 x Ni\n");
}

TEST_F(Obj, AnAmbientColourThatIsNoMultipleOfTheDiffuseOneIsLeftAlone) {
  EXPECT_EQ(material("newmtl one\nKd 1e-200 0.5 0\nKa 1e200 1 1\n").ambient, glm::dvec3(1, 2, 1));
}

TEST_F(Obj, IlluminationWithoutLobesHasNoSpecular) {
  EXPECT_EQ(material("newmtl one\nKs 1 1 1\nillum 1\n").specular, glm::dvec3(0));
  EXPECT_EQ(material("newmtl one\nKs 1 1 1\n").specular, glm::dvec3(1));
  EXPECT_EQ(material("newmtl one\nKs 1 1 1\nillum 5\n").specular, glm::dvec3(1));
  EXPECT_THAT(messages, HasSubstr("1 x illum 5"));
}

TEST_F(Obj, ValuesThatNoMaterialMayHaveAreHeldAndTold) {
  const Material& m = material("newmtl one\nKd 0.5 -1 0\nKa -1 0 0\nKs -0.5\nKe -1 0 2\nNs -5\n");
  EXPECT_EQ(m.diffuse, glm::dvec3(0.5, 0, 0));
  EXPECT_EQ(m.ambient, glm::dvec3(0, 1, 1));
  EXPECT_EQ(m.specular, glm::dvec3(0));
  EXPECT_EQ(m.emission, glm::dvec3(0, 0, 2));
  EXPECT_EQ(m.shininess, 0);
  EXPECT_EQ(messages,
            "a.mtl:2: a material cannot have 1 x Ka -1, 1 x Kd -1, 1 x Ke -1, 1 x Ks -0.5, 1 x Ns -5; it has "
            "the nearest value it can\n");
  EXPECT_EQ(material("newmtl one\nNs 1e9\n").shininess, 1e6);
  EXPECT_THAT(warnings, ElementsAre("values_held"));
  EXPECT_EQ(material("newmtl one\nNs 1e6\nKd 0 0 0\n").shininess, 1e6);
  EXPECT_THAT(warnings, ElementsAre());
}

TEST_F(Obj, MaterialsThatMakeEnergyAreTold) {
  EXPECT_EQ(material("newmtl one\nKd 2 0.5 0\n").diffuse, glm::dvec3(2, 0.5, 0)) << "kept";
  EXPECT_EQ(messages,
            "m.obj: 1 materials send back more light than falls on them; 'one' sends back 2 of it\n");
  material("newmtl one\nKd 0.8\nKs 1\nNs 5\n");
  EXPECT_THAT(warnings, ElementsAre("makes_energy")) << "by the highlight";
  material("newmtl one\nKd 0.8\nKs 1\nNs 5\nillum 1\n");
  EXPECT_THAT(warnings, ElementsAre()) << "there is none";
  material("newmtl one\nKd 1\nKs 0\n");
  EXPECT_THAT(warnings, ElementsAre());
}

TEST_F(Obj, WhatHasNoCounterpartIsCounted) {
  material(
      "newmtl one\nd 1.5\nTr -1\nd -halo 0.5\nmap_Bump -bm 1 b.png\nmap_Ks k.png\nKd spectral f.rfl\nnewmtl "
      "two\nmap_Ks k.png\n");
  EXPECT_EQ(messages,
            "a.mtl: skipped 1 x Kd spectral, 1 x Tr -1, 1 x d -halo, 1 x d 1.5, 1 x map_Bump, 2 x map_Ks\n");
  EXPECT_EQ(mesh.find("transparency"), nullptr);
}

TEST_F(Obj, FacesAreAsOpaqueAsTheirMaterial) {
  EXPECT_EQ(read_mtl("newmtl one\nd 1\n").find("transparency"), nullptr);
  EXPECT_EQ(read_mtl("newmtl one\nTr 1\nd 1\n").find("transparency"), nullptr)
      << "programs do not agree on Tr";
  EXPECT_THAT(values<float>(read_mtl("newmtl one\nd 0.25\n"), "transparency"), ElementsAre(0.75F));
  EXPECT_THAT(values<float>(read_mtl("newmtl one\nTr 0.25\n"), "transparency"), ElementsAre(0.25F));
  EXPECT_EQ(problem("newmtl one\nd clear\n"), "a.mtl:2: 'clear' is not a finite number");
}

TEST_F(Obj, TexturesAreReadOnceAndPlaced) {
  write_picture("two texels.png");
  folder.write("a.mtl",
               "newmtl one\nKd 1 1 1\nmap_Kd -s 2 3 1 -o 0.5 0.25 -clamp on two texels.png\n"
               "newmtl two\nmap_Kd -clamp on -mm 0 1 .\\two texels.png\nnewmtl unused\nmap_Kd nowhere.png\n");
  const Mesh m = read("mtllib a.mtl\n" + triangle +
                      "usemtl one\nf 1/1/1 2/1/1 3/1/1\nusemtl two\nf 1/1/1 2/1/1 3/1/1\n");
  const auto& materials = m.materials->materials;
  ASSERT_EQ(materials.size(), 2u);
  ASSERT_NE(materials[0].texture, nullptr);
  EXPECT_EQ(materials[0].texture, materials[1].texture);
  const auto& pyramid = std::get<MipPyramid>(materials[0].texture->source);
  EXPECT_EQ(pyramid.wrap_u, Wrap::clamp);
  EXPECT_EQ(pyramid.levels[0].width, 2);
  EXPECT_THAT(pyramid.levels[0].rgba,
              testing::Pointwise(testing::FloatNear(1e-6f), std::vector<float>{1, 0, 0, 1, 0, 0, 1, 1}));
  EXPECT_EQ(materials[0].texture_from_uv * glm::dvec3(1, 1, 1), glm::dvec3(2.5, 3.25, 1));
  EXPECT_EQ(materials[1].texture_from_uv, glm::dmat3(1));
  EXPECT_EQ(messages, "a.mtl: skipped 1 x map_Kd -mm\n");
}

TEST_F(Obj, NoTextureIsReadForAMeshWithoutCoordinates) {
  folder.write("a.mtl", "newmtl one\nmap_Kd nowhere.png\n");
  const Mesh m = read("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nusemtl one\nf 1//1 2//1 3//1\n");
  EXPECT_EQ(m.materials->materials[0].texture, nullptr);
  EXPECT_THAT(warnings, testing::IsEmpty());
}

TEST_F(Obj, FilesThatAreNotThereAreSaid) {
  const Mesh m =
      read("mtllib nowhere.mtl\nmtllib nowhere.mtl\n" + triangle + "usemtl red\nf 1/1/1 2/1/1 3/1/1\n");
  EXPECT_EQ(m.materials->materials[0].name, "red");
  EXPECT_EQ(m.materials->materials[0].diffuse, glm::dvec3(0.8));
  EXPECT_EQ(messages,
            "m.obj: there is no file nowhere.mtl\n"
            "m.obj: 1 materials are in no material file; they have the default values\n");
  EXPECT_EQ(material("newmtl one\nmap_Kd nowhere.png\n").texture, nullptr);
  EXPECT_EQ(messages, "a.mtl:2: there is no file nowhere.png\n");
}

TEST_F(Obj, NamesThatLeaveTheFolderAreNotRead) {
  for (const std::string name : {"../a.png", "/etc/passwd", "C:\\a.png", "x/../../a.png", "..\\a.png"}) {
    EXPECT_EQ(material("newmtl one\nmap_Kd " + name + "\n").texture, nullptr);
    EXPECT_THAT(warnings, ElementsAre("unsafe_path")) << name;
    read("mtllib " + name + "\n" + triangle + "usemtl one\nf 1/1/1 2/1/1 3/1/1\n");
    EXPECT_THAT(warnings, ElementsAre("unsafe_path", "missing_material")) << name;
  }
}

TEST_F(Obj, AFileMayNameItself) {
  const std::string text = "mtllib m.obj\n" + triangle + "usemtl one\nf 1/1/1 2/1/1 3/1/1\n";
  folder.write("m.obj", text);
  EXPECT_EQ(read(text).materials->materials.size(), 1u);
  EXPECT_THAT(warnings, ElementsAre("statements_skipped", "missing_material"));
}

TEST_F(Obj, SeveralLibrariesOnOneLineAndNamesWithBlanks) {
  folder.write("a b.mtl", "newmtl one\nKd 1 0 0\n");
  folder.write("c.mtl", "newmtl one\nKd 0 1 0\nnewmtl two\nKd 0 0 1");
  const std::string faces = triangle + "usemtl one\nf 1/1/1 2/1/1 3/1/1\nusemtl two\nf 1/1/1 2/1/1 3/1/1\n";
  EXPECT_EQ(read("mtllib a b.mtl\nmtllib c.mtl\n" + faces).materials->materials[0].diffuse,
            glm::dvec3(1, 0, 0));
  EXPECT_EQ(read("mtllib d.mtl a\\ b.mtl\n" + faces).materials->materials[0].diffuse, glm::dvec3(1, 0, 0));
  EXPECT_THAT(warnings, ElementsAre("missing_material_file", "missing_material"));
  const Mesh m = read("mtllib c.mtl d.mtl\n" + faces);
  EXPECT_EQ(m.materials->materials[0].diffuse, glm::dvec3(0, 1, 0));
  EXPECT_EQ(m.materials->materials[1].diffuse, glm::dvec3(0, 0, 1));
  EXPECT_THAT(warnings, ElementsAre("missing_material_file"));
}

TEST_F(Obj, SaysWhatIsWrongInAMaterialFile) {
  EXPECT_EQ(problem("newmtl one\nKd 1 x 0\n"), "a.mtl:2: 'x' is not a finite number");
  EXPECT_EQ(problem("newmtl one\n\nKd 1 0\n"), "a.mtl:3: Kd needs one number or three, and there are two");
  EXPECT_EQ(problem("newmtl one\nKd\n"), "a.mtl:2: the line ends where a number is needed");
  EXPECT_EQ(problem("newmtl one\nmap_Kd -s\n"), "a.mtl:2: the line ends where a number is needed");
  EXPECT_EQ(problem("newmtl one\nNs 1e400\n"), "a.mtl:2: '1e400' is beyond double precision");
  EXPECT_EQ(problem("newmtl one\nKe nan nan nan\n"), "a.mtl:2: 'nan' is not a finite number");
  EXPECT_EQ(problem("newmtl one\nmap_Kd -s x.png\n"), "a.mtl:2: 'x.png' is not a finite number");
  EXPECT_EQ(problem("\x89PNG\r\n"), "a.mtl:1: '?PNG' is not a statement of an MTL file");
  std::uint32_t state = 1;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  const std::string whole = "newmtl one\nKd 1 0.5 0\nmap_Kd -s 1 2 3 -clamp on a.png\nillum 2\nNs 10\n";
  for (int i = 0; i < 500; ++i) {
    std::string text = whole;
    for (int k = 0; k < 1 + i % 3; ++k) text[random() % text.size()] = static_cast<char>(random());
    problem(text);  // whatever it is, it is a message
  }
}

TEST_F(Obj, APictureThatIsNoneIsToldWithTheLineThatNamesIt) {
  folder.write("no picture.png", "import this");
  EXPECT_THAT(problem("newmtl one\nmap_Kd no picture.png\n"),
              testing::AllOf(testing::StartsWith("a.mtl:2: map_Kd: "), HasSubstr("no picture.png")));
  EXPECT_EQ(material("newmtl one\nmap_Kd\nmap_Kd -clamp on # none\n").texture, nullptr);
  EXPECT_EQ(messages, "a.mtl: skipped 2 x map_Kd without a file\n");
}

TEST_F(Obj, CachesAreToldOfEveryFile) {
  folder.write("a.mtl", "newmtl one\nmap_Kd t.png\nnewmtl two\nmap_Kd ../x.png\n");
  std::set<std::string> visited;
  visit_obj_files("mtllib a.mtl\n# mtllib b.mtl\n", path(),
                  [&](const FilePath& f) { visited.insert(f.written); });
  EXPECT_EQ(visited, (std::set<std::string>{"a.mtl", "b.mtl", "t.png"}));
}

TEST_F(Obj, ColoursOfVerticesAreDecoded) {
  const Mesh m = read("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 0 0 1\nv 9 9 9 1.0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
  const auto half = static_cast<float>(kernels::decode(kernels::Curve::srgb, 0.5));
  EXPECT_THAT(values<glm::vec3>(m, "color"),
              ElementsAre(glm::vec3(1, half, 0), glm::vec3(1), glm::vec3(0, 0, 1)));
  EXPECT_EQ(read("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\n").find("color"), nullptr);
}

TEST_F(Obj, GroupsAreNumberedFromTheirFirstFace) {
  const std::string f = "f 1//1 2//1 3//1\n", v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\n";
  const Mesh m =
      read(v + f + "g unused\ng a b\nf 1//1 2//1 4//1 3//1\no second\n" + f + "g\n" + f + "o\ng a b\n" + f);
  EXPECT_THAT(values<std::uint32_t>(m, "group"), ElementsAre(0, 1, 1, 2, 3, 1));
  EXPECT_EQ(read(v + "o only\ng a\n" + f).find("group"), nullptr);
}

// Every corner at the first v is another vertex: 200,000 of them in well under a second, not in minutes.
TEST_F(Obj, AFanOfSeamsIsNotQuadratic) {
  constexpr int n = 200000;
  std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n";
  for (int i = 0; i < n; ++i) text += fmt::format("vt {} 0\n", i);
  for (int i = 1; i <= n; ++i) text += fmt::format("f 1/{}/1 2/1/1 3/1/1\n", i);
  text += "f 1/20/1 2/1/1 3/1/1\nf 1/150000/1 2/1/1 3/1/1\n";
  const Mesh m = read(text);
  EXPECT_EQ(m.vertices(), n + 2u);
  const auto uv = m.at("uv").values<glm::vec2>();
  for (const int i : {1, 15, 16, 17, 18, n}) {
    const glm::uvec3 t = m.triangles()[static_cast<std::size_t>(i - 1)];
    EXPECT_EQ(uv[t.x].x, static_cast<float>(i - 1));
    EXPECT_EQ(t.x, static_cast<std::uint32_t>(i - 1));
  }
  EXPECT_EQ(m.triangles()[n].x, 19u);
  EXPECT_EQ(m.triangles()[n + 1].x, 149999u);
}

TEST_F(Obj, AByteOrderMarkIsNoStatement) {
  EXPECT_EQ(read("\xEF\xBB\xBFv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1").faces(), 1u);
}

}  // namespace
}  // namespace frustum
