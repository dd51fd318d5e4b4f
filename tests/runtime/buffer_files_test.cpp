#include "runtime/io/buffer_files.h"

#include "runtime/buffers/image.h"
#include "runtime/buffers/mesh.h"
#include "runtime/buffers/value.h"
#include "runtime/core/error.h"
#include "runtime/io/file_bytes.h"
#include "runtime/io/mesh_readers.h"
#include "runtime/io/mesh_writers.h"
#include "runtime/io/vertex_split.h"
#include "tests/support/temp_file.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>

namespace frustum {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

template <class R>
Mesh sheet(std::size_t n) {
  using Vec2 = glm::vec<2, R>;
  using Vec3 = glm::vec<3, R>;
  Mesh m;
  auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, 2 * (n - 1) * (n - 1));
  auto position = Column::make<Vec3>("position", Domain::vertex, n * n, Space::object);
  auto normal = Column::make<Vec3>("normal", Domain::vertex, n * n);
  auto uv = Column::make<Vec2>("uv", Domain::vertex, n * n);
  auto color = Column::make<Vec3>("color", Domain::vertex, n * n);
  auto heat = Column::make<R>("heat", Domain::vertex, n * n);
  auto part = Column::make<std::uint32_t>("part", Domain::face, triangle->rows());
  auto shift = Column::make<std::int32_t>("shift", Domain::vertex, n * n);
  std::uint32_t at = 0;
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t v = j * n + i;
      const R x = static_cast<R>(i) / 3, y = static_cast<R>(j) / 7;
      position->template values<Vec3>()[v] = {x, y, x * y / 9};
      normal->template values<Vec3>()[v] = {i % 2 == 0 ? 0 : 1, 0, i % 2 == 0 ? 1 : 0};
      uv->template values<Vec2>()[v] = {x, R{1} - y};
      color->template values<Vec3>()[v] = {x / 100, y / 100, R{0.25}};
      heat->template values<R>()[v] = x - y;
      shift->template values<std::int32_t>()[v] = -static_cast<std::int32_t>(v);
      if (i + 1 == n || j + 1 == n) continue;
      const auto a = static_cast<std::uint32_t>(v), b = static_cast<std::uint32_t>(n);
      triangle->template values<glm::uvec3>()[at++] = {a, a + 1, a + b + 1};
      triangle->template values<glm::uvec3>()[at++] = {a, a + b + 1, a + b};
    }
  for (std::size_t f = 0; f < part->rows(); ++f)
    part->template values<std::uint32_t>()[f] = static_cast<std::uint32_t>(f % 5);
  m.columns = {triangle, position, normal, uv, color, heat, shift, part};
  EXPECT_EQ(m.validate(), "");
  return m;
}

Buffer buffer(Mesh m) { return Ref<Mesh>(std::make_shared<const Mesh>(std::move(m))); }

Mesh read(const std::string& path, Precision precision = Precision::single) {
  for (const MeshReader& reader : mesh_readers()) {
    if (!path.ends_with(reader.extension)) continue;
    Context ctx;
    ctx.precision = precision;
    const FileBytes bytes({path, path});
    Mesh m = reader.read(bytes.text(), {path, path}, ctx);
    EXPECT_EQ(m.validate(), "");
    return m;
  }
  throw std::runtime_error("no reader for " + path);
}

std::string text_of(const std::string& path) { return std::string(FileBytes({path, path}).text()); }

bool same(const Column& a, const Column& b) {
  return a.kind() == b.kind() && a.width() == b.width() && a.domain() == b.domain() && a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), a.bytes()) == 0;
}

struct Saved {
  std::string path;
  std::vector<std::string> warnings;
};
class Files : public testing::Test {
 protected:
  Saved save(const Buffer& b, const std::string& name) {
    Saved out{folder.file(name), {}};
    save_buffer_file(
        b,
        {.path = out.path,
         .metadata = {{"Software", "frustum test"},
                      {"ImageDescription", "two\nlines"},
                      {"frustum:graph", "12ab"}},
         .warn = [&](std::string_view code,
                     const std::string& what) { out.warnings.push_back(fmt::format("{}: {}", code, what)); }},
        ctx);
    return out;
  }
  std::pair<std::string, std::string> problem(const Buffer& b, const std::string& name) {
    try {
      save(b, name);
    } catch (const NodeError& e) {
      return {e.code, e.what()};
    } catch (const WorldError& e) {
      return {e.code, e.what()};
    }
    return {};
  }
  test::TempFolder folder;
  Context ctx;
};

TEST_F(Files, PlyGivesEveryColumnBackBitForBit) {
  const Mesh m = sheet<float>(150);
  const Mesh again = read(save(buffer(m), "m.ply").path);
  ASSERT_EQ(again.columns.size(), m.columns.size());
  for (const auto& c : m.columns) EXPECT_TRUE(same(*c, again.at(c->name()))) << c->name();
  const Mesh wide = sheet<double>(9);
  const Mesh wide_again = read(save(buffer(wide), "w.ply").path, Precision::real_double);
  for (const auto& c : wide.columns) EXPECT_TRUE(same(*c, wide_again.at(c->name()))) << c->name();
}

TEST_F(Files, ObjGivesPositionsCoordinatesAndNormalsBackBitForBit) {
  const Mesh m = sheet<float>(20);
  const auto [path, warnings] = save(buffer(m), "m.obj");
  const Mesh again = read(path);
  for (const char* name : {"triangle", "position", "normal", "uv"})
    EXPECT_TRUE(same(m.at(name), again.at(name))) << name;
  for (std::size_t i = 0; i < m.vertices(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(again.at("color").number(i, k), m.at("color").number(i, k), 1e-6);
  EXPECT_THAT(warnings, ElementsAre("left_out: OBJ has no place for column 'heat'",
                                    "left_out: OBJ has no place for column 'shift'",
                                    "left_out: OBJ has no place for column 'part'"));
  const Mesh wide = sheet<double>(9);
  const Mesh wide_again = read(save(buffer(wide), "w.obj").path, Precision::real_double);
  for (const char* name : {"position", "uv"}) EXPECT_TRUE(same(wide.at(name), wide_again.at(name))) << name;
}

// Two triangles with a crease between them: normals of corners, coordinates of vertices.
Mesh crease() {
  Mesh m;
  const glm::uvec3 faces[] = {{0, 1, 2}, {1, 0, 3}};
  const glm::vec3 p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, z(0, 0, 1), y(0, 1, 0);
  const glm::vec3 n[] = {z, z, z, y, y, y};
  const std::uint32_t material[] = {1, 0};
  m.columns = {
      Column::make<glm::uvec3>("triangle", Domain::face, std::span<const glm::uvec3>(faces)),
      Column::make<glm::vec3>("position", Domain::vertex, std::span<const glm::vec3>(p), Space::object),
      Column::make<glm::vec3>("normal", Domain::corner, std::span<const glm::vec3>(n)),
      Column::make<std::uint32_t>("material", Domain::face, std::span<const std::uint32_t>(material))};
  MaterialSet set;
  set.materials = {{.name = "floor"},
                   {.name = "back wall", .diffuse = glm::dvec3(0.5, 0, 2), .shininess = 30}};
  m.materials = std::make_shared<const MaterialSet>(std::move(set));
  EXPECT_EQ(m.validate(), "");
  return m;
}

TEST_F(Files, CornersAreSplitWhereAFormatHasVerticesOnly) {
  const Mesh m = read(save(buffer(crease()), "m.ply").path);
  EXPECT_EQ(m.vertices(), 6u);
  EXPECT_EQ(m.faces(), 2u);
  const auto normals = m.at("normal").values<glm::vec3>();
  EXPECT_THAT(std::vector(normals.begin(), normals.end()),
              ElementsAre(glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0, 0, 1), glm::vec3(0, 1, 0),
                          glm::vec3(0, 1, 0), glm::vec3(0, 1, 0)));
  const auto material = m.at("ply_material").values<std::uint32_t>();
  EXPECT_THAT(std::vector(material.begin(), material.end()), ElementsAre(1, 0));
  const Mesh whole = sheet<float>(3);
  EXPECT_EQ(split_corners(whole, ctx).vertices(), whole.vertices());
}

// A sheet whose faces have values of their own: of each square one half, so that corners of both kinds meet.
template <class T>
Mesh with_corners(Mesh m, const char* name) {
  auto column = Column::make<T>(name, Domain::corner, 3 * m.faces());
  for (std::size_t i = 0; i < column->rows(); ++i) column->template values<T>()[i] = T(i / 3 % 2);
  return m.with(std::move(column));
}

// The rule, by a map instead of by sorting.
TEST_F(Files, VerticesAreSplitInTheOrderOfFirstUse) {
  const Mesh m = with_corners<float>(sheet<float>(60), "half");
  const Mesh out = split_corners(m, ctx);
  ASSERT_EQ(out.validate(), "");
  std::map<std::pair<std::uint32_t, float>, std::uint32_t> known;
  std::vector<std::uint32_t> of;
  for (std::size_t i = 0; i < 3 * m.faces(); ++i) {
    const std::uint32_t v = m.triangles()[i / 3][static_cast<glm::length_t>(i % 3)];
    const auto [at, is_new] = known.try_emplace({v, static_cast<float>(i / 3 % 2)}, of.size());
    if (is_new) of.push_back(v);
    ASSERT_EQ(out.triangles()[i / 3][static_cast<glm::length_t>(i % 3)], at->second) << i;
  }
  ASSERT_EQ(out.vertices(), of.size());
  for (std::size_t i = 0; i < of.size(); ++i)
    ASSERT_EQ(out.at("position").values<glm::vec3>()[i], m.at("position").values<glm::vec3>()[of[i]]);
}

// What is claimed is what the lists of a split take; nothing where no corner has values that the format holds.
TEST_F(Files, WhatASplitTakesIsClaimedBeforeItIsTaken) {
  save(buffer(sheet<float>(40)), "no_corners.ply");
  EXPECT_EQ(ctx.claimed(), 0u);
  const Mesh m = with_corners<float>(sheet<float>(40), "half");
  const std::uint64_t lists = 24 * m.faces() + 4 * m.vertices();
  save(buffer(m), "m.ply");
  const std::size_t vertices = read(folder.file("m.ply")).vertices();
  EXPECT_GT(vertices, m.vertices());
  EXPECT_EQ(ctx.claimed(), lists + 8 * vertices);
  for (const char* name : {"refused.ply", "refused.glb"}) {
    ctx = {};
    ctx.admit = [&](std::uint64_t all) {
      if (all >= lists) throw NodeError("memory", "too much");
    };
    EXPECT_EQ(problem(buffer(m), name).first, "memory") << name;
    EXPECT_EQ(ctx.claimed(), lists) << name;
    EXPECT_FALSE(std::filesystem::exists(folder.file(name)));
  }
  ctx = {};
  Mesh plain = sheet<float>(40);
  std::erase_if(plain.columns, [](const Ref<Column>& c) { return c->name() == "uv"; });  // gltf copies it
  save(buffer(with_corners<std::uint32_t>(plain, "label")), "labels.glb");
  EXPECT_EQ(ctx.claimed(), 0u) << "glTF leaves it out";
}

TEST_F(Files, CancelledWritingLeavesNoFile) {
  CancelFlag flag;
  flag.cancel();
  ctx.cancel = &flag;
  const Buffer mesh = buffer(with_corners<float>(sheet<float>(40), "half"));
  for (const char* name : {"m.ply", "m.obj", "m.glb", "m.gltf", "m.csv", "m.json"})
    EXPECT_THROW(save(mesh, name), Cancelled) << name;
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// What was written when the writing ended is seen through a second name of the temporary file.
TEST_F(Files, CancelledWritingEndsWithinRows) {
  const float one[] = {1};
  const Buffer mesh =
      buffer(sheet<float>(600).with(Column::make<float>("area", Domain::mesh, std::span<const float>(one))));
  for (const std::string name : {"m.ply", "m.obj"}) {
    const auto whole = std::filesystem::file_size(save(mesh, name).path);
    const std::string path = folder.file("cut_" + name), seen = folder.file("seen_" + name);
    CancelFlag flag;
    ctx.cancel = &flag;
    const auto cancel = [&](std::string_view, const std::string&) {
      for (const auto& file : std::filesystem::directory_iterator(folder.path()))
        if (file.path().extension() == ".part" && !flag.cancelled())
          std::filesystem::create_hard_link(file.path(), seen);
      flag.cancel();
    };
    EXPECT_THROW(save_buffer_file(mesh, {.path = path, .metadata = {}, .warn = cancel}, ctx), Cancelled);
    ctx.cancel = nullptr;
    EXPECT_FALSE(std::filesystem::exists(path));
    ASSERT_TRUE(std::filesystem::exists(seen)) << name;
    EXPECT_LT(std::filesystem::file_size(seen), whole / 4) << name;
  }
}

TEST_F(Files, ObjKeepsCornersAndNamesOfMaterials) {
  const Mesh m = read(save(buffer(crease()), "m.obj").path);
  EXPECT_EQ(m.vertices(), 6u);  // one for each v//vn
  EXPECT_EQ(m.materials->materials[0].name, "back wall");
  EXPECT_EQ(m.materials->materials[1].name, "floor");
}

// Values of corners that only a seam tells apart, as a sphere has them.
Mesh with_seam(std::size_t n) {
  Mesh m = sheet<float>(n);
  const auto triangles = m.triangles();
  auto uv = Column::make<glm::vec2>("uv", Domain::corner, 3 * m.faces());
  auto normal = Column::make<glm::vec3>("normal", Domain::corner, 3 * m.faces());
  for (std::size_t c = 0; c < 3 * m.faces(); ++c) {
    const std::uint32_t v = triangles[c / 3][static_cast<glm::length_t>(c % 3)];
    uv->values<glm::vec2>()[c] = m.at("uv").values<glm::vec2>()[v];
    normal->values<glm::vec3>()[c] = m.at("normal").values<glm::vec3>()[v];
    if (c < 3 * m.faces() / 2) uv->values<glm::vec2>()[c].x += 1;
  }
  uv->values<glm::vec2>()[0].y = -0.f;  // other bits than 0, which the others at this vertex have
  uv->values<glm::vec2>()[3].y = 0.f;
  std::erase_if(m.columns, [](const auto& c) { return c->name() == "uv" || c->name() == "normal"; });
  m.columns.push_back(uv), m.columns.push_back(normal);
  EXPECT_EQ(m.validate(), "");
  return m;
}

TEST_F(Files, ObjSharesVerticesAsPlyDoes) {
  const Mesh m = with_seam(21);
  const Mesh ply = read(save(buffer(m), "m.ply").path), obj = read(save(buffer(m), "m.obj").path);
  EXPECT_EQ(ply.vertices(), 21u * 21u + 21u + 1u);  // the seam is one row; one corner has a zero of its own
  EXPECT_EQ(obj.vertices(), ply.vertices());
  ASSERT_EQ(obj.faces(), m.faces());
  const auto a = obj.triangles(), b = m.triangles();
  for (std::size_t c = 0; c < 3 * m.faces(); ++c) {
    const auto k = static_cast<glm::length_t>(c % 3);
    const std::uint32_t v = a[c / 3][k];
    const glm::vec2 uv = obj.at("uv").values<glm::vec2>()[v], was = m.at("uv").values<glm::vec2>()[c];
    EXPECT_EQ(std::memcmp(&uv, &was, sizeof uv), 0) << c;
    EXPECT_EQ(obj.at("normal").values<glm::vec3>()[v], m.at("normal").values<glm::vec3>()[c]);
    EXPECT_EQ(obj.at("position").values<glm::vec3>()[v], m.at("position").values<glm::vec3>()[b[c / 3][k]]);
  }
  const std::string text = text_of(folder.file("m.obj"));
  EXPECT_EQ(text, text_of(save(buffer(m), "again.obj").path));
}

// The JSON and the bytes of a glTF file, taken apart here by the letter of its specification.
struct Gltf {
  Json json;
  std::string bytes;
};
std::uint32_t word(const std::string& s, std::size_t at) {
  std::uint32_t v;
  std::memcpy(&v, s.data() + at, 4);
  return v;
}
Gltf glb(const std::string& path) {
  const std::string s = text_of(path);
  EXPECT_EQ(s.substr(0, 4), "glTF");
  EXPECT_EQ(word(s, 4), 2u);
  EXPECT_EQ(word(s, 8), s.size());
  const std::size_t json = word(s, 12);
  EXPECT_EQ(s.substr(16, 4), "JSON");
  EXPECT_EQ(json % 4, 0u);
  EXPECT_EQ(s.substr(24 + json, 4), std::string("BIN\0", 4));
  EXPECT_EQ(word(s, 20 + json), s.size() - 28 - json);
  return {Json::parse(s.substr(20, json)), s.substr(28 + json)};
}
template <class T>
std::vector<T> accessor(const Gltf& g, std::size_t i) {
  const Json& a = g.json["accessors"][i];
  const Json& view = g.json["bufferViews"][a["bufferView"].get<std::size_t>()];
  std::vector<T> out(view["byteLength"].get<std::size_t>() / sizeof(T));
  std::memcpy(out.data(), g.bytes.data() + view["byteOffset"].get<std::size_t>(), out.size() * sizeof(T));
  EXPECT_EQ(g.bytes.size(), g.json["buffers"][0]["byteLength"]);
  return out;
}

TEST_F(Files, GlbHoldsVerticesBitForBit) {
  const Mesh m = sheet<float>(30);
  const auto [path, warnings] = save(buffer(m), "m.glb");
  const Gltf g = glb(path);
  EXPECT_EQ(g.json["asset"]["generator"], "frustum test");
  EXPECT_EQ(g.json["asset"]["extras"]["frustum:graph"], "12ab");
  const Json& primitive = g.json["meshes"][0]["primitives"][0];
  const auto get = [&](const char* name) { return primitive["attributes"][name].get<std::size_t>(); };
  const auto position = m.at("position").values<glm::vec3>();
  EXPECT_EQ(accessor<glm::vec3>(g, get("POSITION")), std::vector(position.begin(), position.end()));
  const auto color = m.at("color").values<glm::vec3>();
  EXPECT_EQ(accessor<glm::vec3>(g, get("COLOR_0")), std::vector(color.begin(), color.end()));
  const auto heat = m.at("heat").values<float>();
  EXPECT_EQ(accessor<float>(g, get("_HEAT")), std::vector(heat.begin(), heat.end()));
  const auto uv = accessor<glm::vec2>(g, get("TEXCOORD_0"));
  for (std::size_t i = 0; i < uv.size(); ++i) {
    EXPECT_EQ(uv[i].x, m.at("uv").values<glm::vec2>()[i].x);
    EXPECT_EQ(uv[i].y, static_cast<float>(1 - m.at("uv").number(i, 1)));
  }
  const auto triangles = m.triangles();
  EXPECT_EQ(accessor<glm::uvec3>(g, primitive["indices"]), std::vector(triangles.begin(), triangles.end()));
  const Json& bounds = g.json["accessors"][get("POSITION")];
  EXPECT_EQ(bounds["min"], Json({0, 0, 0}));
  EXPECT_EQ(bounds["max"][0].get<float>(), position[29].x);
  EXPECT_EQ(bounds["type"], "VEC3");
  EXPECT_THAT(warnings, ElementsAre("left_out: glTF has no place for column 'shift'",
                                    "left_out: glTF has no place for column 'part'"));
}

TEST_F(Files, GltfHasAPrimitiveForEachMaterialAndItsBytesInside) {
  const Gltf g = glb(save(buffer(crease()), "m.glb").path);
  const Json& primitives = g.json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_EQ(primitives[1]["material"], 1);
  EXPECT_EQ(accessor<glm::uvec3>(g, primitives[0]["indices"]), std::vector{glm::uvec3(3, 4, 5)});
  EXPECT_EQ(accessor<glm::uvec3>(g, primitives[1]["indices"]), std::vector{glm::uvec3(0, 1, 2)});
  const Json& material = g.json["materials"][1];
  EXPECT_EQ(material["name"], "back wall");
  EXPECT_EQ(material["pbrMetallicRoughness"]["baseColorFactor"], Json({0.5, 0, 1, 1}));
  EXPECT_DOUBLE_EQ(material["pbrMetallicRoughness"]["roughnessFactor"].get<double>(), 0.5);  // (2 / 32)^(1/4)
  EXPECT_EQ(material["extras"]["frustum"]["shininess"], 30);

  const Json text = Json::parse(text_of(save(buffer(crease()), "m.gltf").path));
  const std::string uri = text["buffers"][0]["uri"], begin = "data:application/octet-stream;base64,";
  ASSERT_TRUE(uri.starts_with(begin));
  std::string bytes;
  std::uint32_t bits = 0;
  int held = 0;
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (const char c : uri.substr(begin.size())) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c)), held += 6;
    if (held >= 8) bytes += static_cast<char>(bits >> (held -= 8) & 255);
  }
  EXPECT_EQ(bytes, g.bytes);
  EXPECT_EQ(text["accessors"], g.json["accessors"]);
}

TEST_F(Files, AMeshWithoutFacesOrVerticesIsAFileToo) {
  Mesh points = sheet<float>(2);
  points = points.with(Column::make<glm::uvec3>("triangle", Domain::face, 0))
               .with(Column::make<std::uint32_t>("part", Domain::face, 0));
  EXPECT_EQ(read(save(buffer(points), "p.ply").path).vertices(), 4u);
  EXPECT_EQ(glb(save(buffer(points), "p.glb").path).json["meshes"][0]["primitives"][0]["mode"], 0);
  Mesh nothing;
  nothing.columns = {Column::make<glm::uvec3>("triangle", Domain::face, 0),
                     Column::make<glm::vec3>("position", Domain::vertex, 0, Space::object)};
  EXPECT_EQ(read(save(buffer(nothing), "n.ply").path).vertices(), 0u);
  EXPECT_EQ(read(save(buffer(nothing), "n.obj").path).vertices(), 0u);
  EXPECT_FALSE(Json::parse(text_of(save(buffer(nothing), "n.gltf").path)).contains("meshes"));
}

TEST_F(Files, PositionsOfFourCoordinatesFitNoFormat) {
  const glm::vec4 p[] = {{0, 0, 0, 1}};
  Mesh m;
  m.columns = {
      Column::make<glm::uvec3>("triangle", Domain::face, 0),
      Column::make<glm::vec4>("position", Domain::vertex, std::span<const glm::vec4>(p), Space::clip)};
  for (const char* name : {"m.ply", "m.obj", "m.glb", "m.gltf"}) {
    EXPECT_EQ(problem(buffer(m), name).first, "format_cannot_hold");
    EXPECT_THAT(problem(buffer(m), name).second, HasSubstr("positions in clip space have four numbers"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));  // nothing half-written
}

TEST_F(Files, NumbersMatricesAndTablesAreTexts) {
  const Buffer number = Ref<Number>(std::make_shared<const Number>(Number{0.1}));
  EXPECT_EQ(text_of(save(number, "n.csv").path), "value\r\n0.1\r\n");
  const Json n = Json::parse(text_of(save(number, "n.json").path));
  EXPECT_EQ(n["format"], "frustum.buffer/1");
  EXPECT_EQ(n["type"], "number");
  EXPECT_EQ(n["graph"], "12ab");
  EXPECT_EQ(n["summary"]["value"], 0.1);
  EXPECT_EQ(n["rows"], Json::parse("[[0.1]]"));
  const Buffer matrix = Ref<Matrix>(std::make_shared<const Matrix>());
  EXPECT_EQ(text_of(save(matrix, "m.csv").path),
            "x,y,z,w\r\n1.0,0.0,0.0,0.0\r\n0.0,1.0,0.0,0.0\r\n0.0,0.0,1.0,0.0\r\n0.0,0.0,0.0,1.0\r\n");
  Table t;
  t.columns = {{.name = "a, \"b\"", .unit = "m", .numbers = {1, 2.5}},
               {.name = "text", .texts = {"x\ny", "\xff"}}};
  const Buffer table = Ref<Table>(std::make_shared<const Table>(t));
  EXPECT_EQ(text_of(save(table, "t.csv").path), "\"a, \"\"b\"\" [m]\",text\r\n1.0,\"x\ny\"\r\n2.5,\xff\r\n");
  EXPECT_EQ(Json::parse(text_of(save(table, "t.json").path))["rows"][0], Json({1.0, "x\ny"}));
}

TEST_F(Files, LongTablesAreWhole) {
  const Mesh m = sheet<float>(100);  // several blocks of rows
  const Json j = Json::parse(text_of(save(buffer(m), "m.json").path));
  EXPECT_EQ(j["rows"].size(), j["total"].get<std::size_t>());
  EXPECT_EQ(j["total"], m.faces());
  const std::string csv = text_of(save(buffer(m), "m.csv").path);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), m.faces() + 1);
}

TEST_F(Files, WhatCannotBeWrittenLeavesNothing) {
  const Buffer number = Ref<Number>(std::make_shared<const Number>(Number{1}));
  EXPECT_EQ(problem(number, "n.ply").first, "unknown_format");
  EXPECT_EQ(problem(number, "n.ply").second, folder.file("n.ply") + ": a number is saved as csv, json");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_EQ(problem(number, "/proc/n.json").first, "cannot_write_file");
  std::filesystem::create_directory(folder.file("taken.csv"));
  EXPECT_EQ(problem(number, "taken.csv").first, "cannot_write_file");  // a folder has that name
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

// What graphs are checked against is what can be written: every form of every kind here.
TEST_F(Files, EveryFormOfAKindIsWritten) {
  const Buffer buffers[] = {buffer(sheet<float>(3)), Ref<Number>(std::make_shared<const Number>()),
                            Ref<Matrix>(std::make_shared<const Matrix>()),
                            Ref<Table>(std::make_shared<const Table>())};
  for (const Buffer& b : buffers)
    for (const std::string& form : saved_as(b.type()))
      EXPECT_EQ(problem(b, "f." + form).first, "") << b.type().name << form;
  EXPECT_THAT(saved_as(buffer_type<Image>()), ElementsAre("csv", "json"));
}

// No reader takes such a file, ours neither.
TEST_F(Files, OfMeshesHoldFinitePositions) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  for (const float odd : {infinity, -infinity, std::numeric_limits<float>::quiet_NaN()}) {
    Mesh m = sheet<float>(3);
    const auto broken = std::make_shared<Column>(m.at("position"));
    broken->values<glm::vec3>()[7].y = odd;
    for (auto& column : m.columns)
      if (column->name() == "position") column = broken;
    for (const char* name : {"m.ply", "m.obj", "m.glb", "m.gltf"}) {
      const auto [code, message] = problem(buffer(m), name);
      EXPECT_EQ(code, "format_cannot_hold") << name;
      EXPECT_THAT(message, HasSubstr("vertex 7 is at (0.33333334"));
    }
    EXPECT_NO_THROW(save(buffer(m), "m.csv"));
    EXPECT_NO_THROW(save(buffer(m), "m.json"));
  }
}

}  // namespace
}  // namespace frustum
