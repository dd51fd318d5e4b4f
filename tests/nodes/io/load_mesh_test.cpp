#include "nodes/io.h"
#include "runtime/buffers/mesh.h"
#include "runtime/io/obj.h"
#include "runtime/io/obj_parse.h"
#include "runtime/io/triangulate.h"
#include "tests/support/run_node.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <tbb/global_control.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <cmath>

namespace frustum {
namespace {

using testing::HasSubstr;

Mesh read(const std::string& text, Context& ctx) { return read_obj(text, {"m.obj", "m.obj"}, ctx); }
Mesh read(const std::string& text) {
  Context ctx;
  Mesh m = read(text, ctx);
  EXPECT_EQ(m.validate(), "");
  return m;
}
std::string problem(const std::string& text) {
  try {
    Context ctx;
    read(text, ctx);
  } catch (const NodeError& e) {
    EXPECT_EQ(e.code, "malformed_file");
    return e.what();
  }
  return "";
}
std::vector<std::string> warnings(const Context& ctx) {
  std::vector<std::string> codes;
  for (const auto& [code, text] : ctx.warnings()) codes.push_back(code);
  return codes;
}
std::vector<glm::uvec3> faces(const Mesh& m) { return {m.triangles().begin(), m.triangles().end()}; }
std::vector<glm::vec3> column3(const Mesh& m, std::string_view name) {
  const auto v = m.at(name).values<glm::vec3>();
  return {v.begin(), v.end()};
}

TEST(LoadMesh, ReadsWhatAFileSays) {
  const Mesh m = read(
      "# a square\r\nmtllib a.mtl\r\no square\nv 0 0 0\nv +1 0 0 1.0\nv 1 1e0 .0\nv 0 1 0\nvt 0.25\nvt 1 "
      "0\nvt 1 1 0\nvt 0 1\n"
      "vn 0 0 2\nusemtl red paint \nf 1/1/1 2/2/1 3/3/1 4/4/1 # a quad\n");
  EXPECT_EQ(column3(m, "position"), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(faces(m), (std::vector<glm::uvec3>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(column3(m, "normal"), std::vector<glm::vec3>(4, {0, 0, 1}));
  EXPECT_EQ(m.at("uv").values<glm::vec2>()[0], glm::vec2(0.25f, 0));
  EXPECT_EQ(m.materials->materials.at(0).name, "red paint");
  EXPECT_EQ(m.space(), Space::object);
}

TEST(LoadMesh, KeepsOneVertexForEachTripleInTheOrderOfPositions) {
  // Two triangles that share an edge; at v 2 they have different texture coordinates: a seam.
  const Mesh m = read(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0.5 0.5\nvn 0 0 1\n"
      "f 2/3/1 5/1/1 3/1/1\nf 1/1/1 2/2/1 3/1/1\n");
  // v 4 is used by no face: positions 1, 2, 2, 3, 5.
  EXPECT_EQ(column3(m, "position"),
            (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(faces(m), (std::vector<glm::uvec3>{{1, 4, 3}, {0, 2, 3}}));
  EXPECT_EQ(m.at("uv").values<glm::vec2>()[1], glm::vec2(0.5f));
  EXPECT_EQ(m.at("uv").values<glm::vec2>()[2], glm::vec2(1, 0));
}

TEST(LoadMesh, NegativeIndicesCountBackwardsFromTheirLine) {
  const Mesh m = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\nf -4 -3 -1\n");
  EXPECT_EQ(faces(m), (std::vector<glm::uvec3>{{0, 1, 2}, {0, 1, 3}}));
}

TEST(LoadMesh, LinesMayBeContinued) {
  EXPECT_EQ(faces(read("v 0 0 0\nv 1 \\\n 0 0\nv 0 1 0\nf 1 \\\r\n 2 3\n")),
            (std::vector<glm::uvec3>{{0, 1, 2}}));
}

TEST(LoadMesh, NormalsThatAreMissingAreWeightedByArea) {
  Context ctx;
  // At vertex 1 meet a face of area 2 in z and one of area 1/2 in x.
  const Mesh m = read("v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 1\nv 0 1 0\nf 1 2 3\nf 1 5 4\n", ctx);
  const glm::vec3 n = column3(m, "normal")[0];
  const float length = std::sqrt(17.0f);
  EXPECT_NEAR(n.x, 1 / length, 1e-7);
  EXPECT_NEAR(n.z, 4 / length, 1e-7);
  EXPECT_EQ(warnings(ctx), std::vector<std::string>{"normals_computed"});
}

TEST(LoadMesh, ASeamInTextureCoordinatesMakesNoCrease) {
  const Mesh m = read("v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 3/1 2/1\nf 1/2 2/2 4/2\n");
  const auto p = column3(m, "position"), n = column3(m, "normal");
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = 0; j < p.size(); ++j)
      if (p[i] == p[j]) {
        EXPECT_EQ(n[i], n[j]);
      }
}

TEST(LoadMesh, FacesWithoutAreaStillHaveUnitNormals) {
  const Mesh m = read("v 0 0 0\nv 1 0 0\nv 2 0 0\nvn 0 0 0\nf 1//1 2//1 3//1\n");
  for (const glm::vec3& n : column3(m, "normal")) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

TEST(LoadMesh, DoublePrecisionKeepsEveryDigitAndSingleRoundsOnce) {
  Context ctx;
  ctx.precision = Precision::real_double;
  const std::string text = "v 0.1 7.038531e-26 1e-400\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(read(text, ctx).at("position").values<glm::dvec3>()[0], glm::dvec3(0.1, 7.038531e-26, 0));
  // 7.038531e-26 is nearest to 0x1.5c87fap-84 in single; through double it would be 0x1.5c87fcp-84.
  EXPECT_EQ(column3(read(text), "position")[0], glm::vec3(0.1f, 0x1.5c87fap-84f, 0));
}

TEST(LoadMesh, MaterialsFollowUsemtlAcrossFaces) {
  const Mesh m = read(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nusemtl a\nf 1 2 3 4\nusemtl b\nusemtl a\nf 1 2 3\nusemtl "
      "b\nf 1 2 3\n");
  const auto ids = m.at("material").values<std::uint32_t>();
  EXPECT_EQ((std::vector<std::uint32_t>(ids.begin(), ids.end())),
            (std::vector<std::uint32_t>{0, 1, 1, 1, 2}));
  EXPECT_EQ(m.materials->materials[0].name, "");
  EXPECT_EQ(m.materials->materials[2].name, "b");
}

TEST(LoadMesh, NothingIsAnEmptyMesh) {
  Context ctx;
  const Mesh m = read("# nothing\n", ctx);
  EXPECT_EQ(m.validate(), "");
  EXPECT_EQ(m.faces(), 0u);
  EXPECT_EQ(m.vertices(), 0u);
  EXPECT_EQ(warnings(ctx), std::vector<std::string>{"no_faces"});
}

TEST(LoadMesh, NamesTheLineThatIsWrong) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(problem(v + "f 1 2\n"), HasSubstr("m.obj:4: a face needs 3 corners, and this has 2"));
  EXPECT_THAT(problem(v + "f 1 2 x\n"), HasSubstr("m.obj:4: 'x' is not a corner"));
  EXPECT_THAT(problem(v + "f 1 2 0\n"), HasSubstr("m.obj:4: '0' is not a corner"));
  EXPECT_THAT(problem(v + "f 1 2 3/\n"), HasSubstr("'3/' is not a corner"));
  EXPECT_THAT(problem(v + "\nf 1 2 3\nf 1 2 4\n"),
              HasSubstr("m.obj:6: a corner names what is not there: the file has 3 v, 0 vt"));
  EXPECT_THAT(problem(v + "f 1 2 3\nf 1 2 -4\n"), HasSubstr("m.obj:5: a corner names"));
  EXPECT_THAT(problem(v + "f 1/1 2/1 3/1\n"), HasSubstr("m.obj:4: a corner names"));
  EXPECT_THAT(problem(v + "f 1 2 99999999999\n"), HasSubstr("is not a corner"));
  EXPECT_THAT(problem("v 1 2\n"), HasSubstr("m.obj:1: 3 numbers are needed, and there are 2"));
  EXPECT_THAT(problem("v 1 2 nan\n"), HasSubstr("'nan' is not a finite number"));
  EXPECT_THAT(problem("v 1 2 1e999\n"), HasSubstr("'1e999' is beyond single precision"));
  EXPECT_THAT(problem("v 1 2 3x\n"), HasSubstr("'3x' is not a finite number"));
  EXPECT_THAT(problem(std::string("\x89PNG\r\n\x1a\n\0\0", 10)),
              HasSubstr("m.obj:1: '?PNG' is not a statement"));
}

TEST(LoadMesh, SkipsAndNamesStatementsThatSayNothingAboutTriangles) {
  Context ctx;
  read("v 0 0 0\nv 1 0 0\nv 0 1 0\ng a\ng b\ns off\nl 1 2\nl 2 3\nvn 0 0 1\nf 1//1 2//1 3//1\n", ctx);
  ASSERT_EQ(ctx.warnings().size(), 1u);
  EXPECT_EQ(ctx.warnings()[0].second, "m.obj: skipped 2 x l");
  EXPECT_THAT(ctx.counters(), testing::Contains(std::pair<std::string, std::uint64_t>("groups", 2)));
}

TEST(LoadMesh, ChunksBreakAtLineEndsOnly) {
  const std::string text = "v 1 2 3\nf 1 \\\n2 3\n\nv 4 5 6";
  for (std::size_t size = 1; size < 40; ++size) {
    std::string joined;
    for (const std::string_view piece : obj::split_lines(text, size)) {
      joined += piece;
      EXPECT_TRUE(joined.size() == text.size() ||
                  (joined.back() == '\n' && joined[joined.size() - 2] != '\\'))
          << size;
    }
    EXPECT_EQ(joined, text);
  }
}

// A file of several chunks, with polygons, seams and relative indices.
std::string large() {
  std::string text;
  for (int i = 0; i < 60'000; ++i) {
    const std::string x = std::to_string(i);
    text += "v " + x + " 0 0.5\nv " + x + " 1 0\nv " + x + ".5 1 0\nv " + x + ".5 0 0\nvt 0." + x + " 0\n";
    text += "f -4/-1 -3/-1 -2/-1 -1/-1\nf 1/1 " + std::to_string(4 * i + 2) + "/1 " +
            std::to_string(4 * i + 3) + "/" + std::to_string(i + 1) + "\n";
  }
  return text;
}

TEST(LoadMesh, TheNumberOfThreadsDoesNotShow) {
  const std::string text = large();
  ASSERT_GT(text.size(), std::size_t{4} << 20);
  std::vector<Digest> digests;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    digests.push_back(Buffer(std::make_shared<const Mesh>(read(text))).digest());
  }
  EXPECT_EQ(digests[0], digests[1]);
  EXPECT_EQ(digests[0], digests[2]);
}

TEST(LoadMesh, AnErrorFarIntoAFileKnowsItsLine) {
  const std::string text = large();
  EXPECT_THAT(problem(text + "f 1 2\n"), HasSubstr("m.obj:420001:"));
  EXPECT_THAT(problem(text + "f 1 2 240001\n"), HasSubstr("m.obj:420001:"));
}

TEST(LoadMesh, CancellingEndsIt) {
  CancelFlag cancel;
  cancel.cancel();
  Context ctx;
  ctx.cancel = &cancel;
  EXPECT_THROW(read(large(), ctx), Cancelled);
}

double area(std::span<const glm::dvec3> p, const std::vector<std::array<std::uint32_t, 3>>& triangles,
            double& smallest) {
  double sum = 0;
  for (const auto& t : triangles) {
    const double a = glm::cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z / 2;
    sum += a, smallest = std::min(smallest, a);
  }
  return sum;
}

TEST(Triangulate, TilesAPolygonThatIsNotConvex) {
  // A chevron, and an L; from every starting corner all triangles face up and their areas sum to the
  // polygon's.
  const std::vector<std::vector<glm::dvec3>> shapes{
      {{0, 0, 0}, {2, 2, 0}, {0, 1, 0}, {-2, 2, 0}},
      {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}}};
  const double areas[] = {2, 5};
  for (std::size_t s = 0; s < shapes.size(); ++s)
    for (std::size_t start = 0; start < shapes[s].size(); ++start) {
      std::vector<glm::dvec3> p = shapes[s];
      std::rotate(p.begin(), p.begin() + static_cast<std::ptrdiff_t>(start), p.end());
      std::vector<std::array<std::uint32_t, 3>> triangles;
      EXPECT_TRUE(triangulate(p, triangles));
      EXPECT_EQ(triangles.size(), p.size() - 2);
      double smallest = 1;
      EXPECT_DOUBLE_EQ(area(p, triangles, smallest), areas[s]);
      EXPECT_GT(smallest, 0);
    }
}

TEST(Triangulate, SaysWhereItHadToGuess) {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  EXPECT_FALSE(triangulate(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, triangles));
  EXPECT_EQ(triangles.size(), 2u);
}

// The example's house: 2 pentagons and 5 quads; closed and wound outwards, so the volume is 2 x 3 x 2 + 2 x
// 3 x 1 / 2.
TEST(LoadMesh, TheHouseHasItsVolume) {
  const auto out = test::run_node(nodes::io_load_mesh(), {{"file", "house.obj"}}, {}, nullptr,
                                  std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data");
  const Mesh& m = *out.at(0).as<Mesh>();
  EXPECT_EQ(m.faces(), 16u);
  EXPECT_EQ(m.vertices(), 30u);
  EXPECT_EQ(m.materials->materials.size(), 3u);
  const auto p = column3(m, "position");
  double volume = 0;
  for (const glm::uvec3& t : m.triangles())
    volume += glm::dot(glm::dvec3(p[t.x]), glm::cross(glm::dvec3(p[t.y]), glm::dvec3(p[t.z]))) / 6;
  EXPECT_DOUBLE_EQ(volume, 15);
}

TEST(LoadMesh, ReadsByExtension) {
  const test::TempFolder folder;
  folder.write("m.xyz", "0 0 0\n");
  EXPECT_EQ(test::run_error(nodes::io_load_mesh(), {{"file", "m.xyz"}}, {}, folder.path()).first,
            "unknown_format");
  EXPECT_EQ(test::run_error(nodes::io_load_mesh(), {{"file", "m.obj"}}, {}, folder.path()).first,
            "cannot_read_file");
  folder.write("M.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3");
  EXPECT_EQ(test::run_node(nodes::io_load_mesh(), {{"file", "M.OBJ"}}, {}, nullptr, folder.path())
                .at(0)
                .as<Mesh>()
                ->faces(),
            1u);
}

}  // namespace
}  // namespace frustum
