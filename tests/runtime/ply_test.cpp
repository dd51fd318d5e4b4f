#include "runtime/io/ply.h"

#include "nodes/kernels/transfer.h"
#include "tests/support/mesh_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <cmath>

namespace frustum {
namespace {

using test::Bytes;
using test::values;
using testing::ElementsAre;
using testing::HasSubstr;

test::Reading read(std::string_view bytes, Precision precision = Precision::single) {
  return test::read_with(read_ply, bytes, "m.ply", precision);
}
std::string problem(std::string_view bytes) { return test::problem_with(read_ply, bytes, "m.ply"); }

const std::string square =
    "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";

TEST(Ply, ReadsText) {
  const auto [m, warnings] = read(square);
  EXPECT_THAT(values<glm::vec3>(m, "position"),
              ElementsAre(glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(1, 1, 0), glm::vec3(0, 1, 0)));
  EXPECT_THAT(values<glm::uvec3>(m, "triangle"), ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
  EXPECT_EQ(values<glm::vec3>(m, "normal"), std::vector<glm::vec3>(4, {0, 0, 1}));
  EXPECT_EQ(m.space(), Space::object);
  EXPECT_THAT(warnings, ElementsAre("normals_computed"));
}

TEST(Ply, LineEndsBlankLinesAndAMissingLastOneDoNotMatter) {
  const std::string unix_text = square + "";
  for (const char* eol : {"\r\n", "\r", "\n\n"}) {
    std::string text;
    const std::size_t body = square.find("end_header");
    for (std::size_t i = 0; i < square.size(); ++i)
      // The header has no blank lines; the body may.
      text += square[i] != '\n' ? std::string(1, square[i]) : eol[0] == '\n' && i < body ? "\n" : eol;
    EXPECT_EQ(values<glm::uvec3>(read(text).mesh, "triangle").size(), 2u) << eol;
    while (text.back() == '\n' || text.back() == '\r') text.pop_back();
    EXPECT_EQ(values<glm::vec3>(read(text).mesh, "position"),
              values<glm::vec3>(read(unix_text).mesh, "position"));
  }
}

// A triangle in every type of number, with properties in an order of no program.
template <class Index, class Count>
std::string binary(bool big, const char* index_type, const char* count_type) {
  std::string text = fmt::format(
      "ply\nformat binary_{}_endian 1.0\nelement edge 2\nproperty short a\nproperty list uchar double b\n"
      "element face 2\nproperty uchar flags\nproperty list {} {} vertex_index\nproperty double area\n"
      "element vertex 4\nproperty uchar red\nproperty double z\nproperty float nx\nproperty short x\n"
      "property uchar green\nproperty float ny\nproperty float nz\nproperty int y\nproperty uchar blue\n"
      "property float s\nproperty float t\nproperty float quality\nproperty list uchar float "
      "weights\nend_header\n",
      big ? "big" : "little", count_type, index_type);
  Bytes b(big);
  b.add(short{1}, std::uint8_t{2}, 1.0, 2.0, short{3}, std::uint8_t{0});
  b.add(std::uint8_t{7}, static_cast<Count>(3), static_cast<Index>(0), static_cast<Index>(1),
        static_cast<Index>(2), 0.5);
  b.add(std::uint8_t{9}, static_cast<Count>(4), static_cast<Index>(0), static_cast<Index>(1),
        static_cast<Index>(2), static_cast<Index>(3), 1.0);
  const auto vertex = [&](short x, int y, double z, std::uint8_t grey, float s) {
    b.add(grey, z, 0.0f, x, grey, 0.0f, 2.0f, y, std::uint8_t{255}, s, 1 - s, 0.5f * s, std::uint8_t{1},
          1.5f);
  };
  vertex(0, 0, 0.1, 0, 0), vertex(2, 0, 0.1, 128, 1), vertex(2, 2, 0.1, 255, 1), vertex(0, 2, 0.1, 0, 0);
  return text + b.text;
}

template <class Index, class Count>
void expect_binary(const char* index_type, const char* count_type) {
  for (const bool big : {false, true}) {
    const auto [m, warnings] = read(binary<Index, Count>(big, index_type, count_type));
    EXPECT_THAT(values<glm::uvec3>(m, "triangle"),
                ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)));
    EXPECT_EQ(values<glm::vec3>(m, "position")[2], glm::vec3(2, 2, 0.1f));
    EXPECT_EQ(values<glm::vec3>(m, "normal")[3], glm::vec3(0, 0, 1));
    EXPECT_EQ(values<glm::vec2>(m, "uv")[1], glm::vec2(1, 0));
    const auto grey = static_cast<float>(kernels::decode(kernels::Curve::srgb, 128 / 255.0));
    EXPECT_EQ(values<glm::vec3>(m, "color")[1], glm::vec3(grey, grey, 1));
    EXPECT_THAT(values<float>(m, "quality"), ElementsAre(0, 0.5f, 0.5f, 0));
    EXPECT_THAT(values<std::uint32_t>(m, "flags"), ElementsAre(7, 9, 9));
    EXPECT_THAT(values<float>(m, "area"), ElementsAre(0.5f, 1, 1));
    EXPECT_THAT(warnings, ElementsAre("properties_skipped"));
  }
}

TEST(Ply, ReadsBothByteOrdersAndAllTypesOfIndices) {
  expect_binary<std::int8_t, std::uint8_t>("char", "uchar");
  expect_binary<std::uint8_t, std::int8_t>("uint8", "int8");
  expect_binary<std::int16_t, std::uint16_t>("short", "ushort");
  expect_binary<std::uint16_t, std::int16_t>("uint16", "int16");
  expect_binary<std::int32_t, std::uint32_t>("int", "uint32");
  expect_binary<std::uint32_t, std::int32_t>("uint", "int32");
  expect_binary<float, std::uint8_t>("float32", "uint8");
  expect_binary<double, std::uint8_t>("double", "uchar");
}

TEST(Ply, EveryBitOfADoubleIsKeptInDouble) {
  Bytes b;
  b.add(0.1, 1e300, -0.0);
  const auto m = read(
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty double x\nproperty double y\n"
      "property double z\nend_header\n" +
          b.text,
      Precision::real_double);
  EXPECT_EQ(values<glm::dvec3>(m.mesh, "position")[0], glm::dvec3(0.1, 1e300, 0));
  EXPECT_TRUE(std::signbit(values<glm::dvec3>(m.mesh, "position")[0].z));
  EXPECT_THAT(m.warnings, ElementsAre("no_faces"));
  EXPECT_EQ(m.mesh.faces(), 0u);
  EXPECT_EQ(m.mesh.find("normal"), nullptr);
}

const std::string vertex_header =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
const std::string face_header = "element face 1\nproperty list uchar int vertex_indices\n";

TEST(Ply, RealColoursAreLinearAndAlphaIsKept) {
  const auto m =
      read(
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "property float red\nproperty float green\nproperty float blue\nproperty float alpha\nend_header\n"
          "0 0 0 0.5 2 0 0.25\n")
          .mesh;
  EXPECT_EQ(values<glm::vec4>(m, "color")[0], glm::vec4(0.5f, 2, 0, 0.25f));
  const auto n =
      read(
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "property ushort red\nproperty ushort green\nproperty ushort blue\nproperty ushort alpha\n"
          "end_header\n0 0 0 65535 0 32768 32768\n")
          .mesh;
  const auto grey = static_cast<float>(kernels::decode(kernels::Curve::srgb, 32768 / 65535.0));
  EXPECT_EQ(values<glm::vec4>(n, "color")[0], glm::vec4(1, 0, grey, 32768 / 65535.0f));
}

TEST(Ply, FurtherCoordinatesComeBackAsTheyAreWritten) {
  const auto [m, warnings] = read(
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "property float uv1_x\nproperty float uv15_y\nproperty float uv1_y\nproperty float uv15_x\n"
      "property float uv16_x\nproperty float uv16_y\nproperty float uv2_x\nend_header\n0 0 0 1 2 3 4 5 6 "
      "7\n");
  EXPECT_EQ(m.validate(), "");
  EXPECT_EQ(values<glm::vec2>(m, "uv1")[0], glm::vec2(1, 3));
  EXPECT_EQ(values<glm::vec2>(m, "uv15")[0], glm::vec2(4, 2));
  EXPECT_EQ(values<float>(m, "ply_uv16_x")[0], 5);
  EXPECT_EQ(values<float>(m, "ply_uv2_x")[0], 7) << "half a pair";
  EXPECT_THAT(warnings, ElementsAre("no_faces"));
}

TEST(Ply, NamesWithAMeaningHereAreSetApart) {
  const auto m =
      read(
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
          "property float w\nproperty char uv\nend_header\n0 0 0 3 -4\n")
          .mesh;
  EXPECT_THAT(values<float>(m, "ply_w"), ElementsAre(3));
  EXPECT_THAT(values<std::int32_t>(m, "ply_uv"), ElementsAre(-4));
}

TEST(Ply, NumbersOfVerticesAndFacesMayHaveTheSameName) {
  const auto m = read(
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nproperty float quality\nproperty uchar ply_w\nproperty uchar w\n"
                     "element face 1\nproperty list uchar int vertex_indices\nproperty float quality\n"
                     "end_header\n0 0 0 1 4 7\n1 0 0 2 5 8\n0 1 0 3 6 9\n3 0 1 2 0.5\n")
                     .mesh;
  EXPECT_THAT(values<float>(m, "quality"), ElementsAre(1, 2, 3));
  EXPECT_THAT(values<float>(m, "face_quality"), ElementsAre(0.5f));
  EXPECT_THAT(values<std::uint32_t>(m, "ply_w"), ElementsAre(4, 5, 6));
  EXPECT_THAT(values<std::uint32_t>(m, "ply_w_2"), ElementsAre(7, 8, 9));
}

TEST(Ply, CoordinatesOfCornersMakeSeams) {
  const auto [m, warnings] = read(vertex_header +
                                  "element face 2\nproperty list uchar int vertex_indices\n"
                                  "property list uchar float texcoord\nend_header\n" +
                                  three + "3 0 1 2 6 0 0 1 0 0 1\n3 2 1 0 0\n");
  EXPECT_THAT(values<glm::vec2>(m, "uv"), ElementsAre(glm::vec2(0), glm::vec2(1, 0), glm::vec2(0, 1),
                                                      glm::vec2(0), glm::vec2(0), glm::vec2(0)));
  EXPECT_EQ(m.at("uv").domain(), Domain::corner);
  EXPECT_THAT(warnings, ElementsAre("normals_computed", "uv_missing"));
}

TEST(Ply, ColoursOfFacesAreThoseOfTheirCorners) {
  const std::string face = "element face 2\nproperty list uchar int vertex_indices\n";
  const std::string colors = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string rows = three + "3 0 1 2 255 0 128\n3 2 1 0 0 255 0\n";
  const auto m = read(vertex_header + face + colors + "end_header\n" + rows).mesh;
  EXPECT_EQ(m.validate(), "");
  EXPECT_EQ(m.at("color").domain(), Domain::corner);
  const glm::vec3 first(1, 0, static_cast<float>(kernels::decode(kernels::Curve::srgb, 128 / 255.0))),
      second(0, 1, 0);
  EXPECT_THAT(values<glm::vec3>(m, "color"), ElementsAre(first, first, first, second, second, second));
  EXPECT_EQ(m.find("red"), nullptr);
  const auto both =
      read(vertex_header + colors + face + colors +
           "end_header\n0 0 0 255 0 0\n1 0 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2 0 0 9\n3 2 1 0 0 0 8\n")
          .mesh;
  EXPECT_EQ(values<glm::vec3>(both, "color"), std::vector<glm::vec3>(3, {1, 0, 0})) << "vertices come first";
  EXPECT_THAT(values<std::uint32_t>(both, "blue"), ElementsAre(9, 8)) << "numbers of the faces";
}

TEST(Ply, AQuadrilateralGivesItsColourToBothTriangles) {
  std::string text = square;
  text.insert(text.find("end_header"), "property float red\nproperty float green\nproperty float blue\n");
  text.insert(text.size() - 1, " 0.5 0.25 2");
  EXPECT_EQ(values<glm::vec3>(read(text).mesh, "color"), std::vector<glm::vec3>(6, {0.5F, 0.25F, 2}));
}

TEST(Ply, PicturesOfCommentsAreToldAsSkipped) {
  std::string text = square;
  text.insert(text.find("element"), "comment TextureFile skin.png\n");
  Context ctx;
  read_ply(text, {"m.ply", "m.ply"}, ctx);
  ASSERT_EQ(ctx.warnings().size(), 2u);
  EXPECT_EQ(ctx.warnings()[1].second, "m.ply: skipped TextureFile skin.png");
}

TEST(Ply, StripsBecomeTriangles) {
  const auto m =
      read(
          "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
          "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
          "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n9 0 1 2 3 -1 1 4 3 3\n")
          .mesh;
  EXPECT_THAT(values<glm::uvec3>(m, "triangle"),
              ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(2, 1, 3), glm::uvec3(1, 4, 3)));
}

TEST(Ply, FacesOfFewCornersAreCounted) {
  const auto [m, warnings] =
      read(vertex_header + "element face 3\nproperty list uchar int vertex_indices\nend_header\n" + three +
           "0\n2 0 1\n3 0 1 2\n");
  EXPECT_EQ(m.faces(), 1u);
  EXPECT_THAT(warnings, ElementsAre("normals_computed", "faces_skipped"));
}

TEST(Ply, SaysWhatIsWrongAndWhere) {
  const auto body = [](const std::string& text) {
    return vertex_header + face_header + "end_header\n" + text;
  };
  EXPECT_EQ(problem(""), "m.ply:1: it does not begin with a line 'ply'");
  EXPECT_EQ(problem("plx\n"), "m.ply:1: it does not begin with a line 'ply'");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\n"), "m.ply:2: the header has no 'end_header'");
  EXPECT_EQ(problem("ply\nformat utf8 1.0\nend_header\n"),
            "m.ply:2: 'utf8' is not a format: ascii, binary_little_endian or binary_big_endian");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\nend_header\n"), "m.ply: it has no element 'vertex'");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\nelement vertex -1\nend_header\n"),
            "m.ply:3: '-1' is not how many elements there are");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\nproperty float x\nend_header\n"),
            "m.ply:3: a property stands before the first element");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\nelement vertex 0\nproperty real x\nend_header\n"),
            "m.ply:4: 'real' is not a type of numbers");
  EXPECT_EQ(problem("ply\nformat ascii 1.0\nelement vertex 0\nproperty list float int x\nend_header\n"),
            "m.ply:4: the length of a list is a whole number");
  EXPECT_EQ(problem(body("0 0 0\n1 0 0\n0 1\n3 0 1 2\n")),
            "m.ply:12: vertex 2: the row ends before all of its numbers");
  EXPECT_EQ(problem(body("0 0 0\n1 0 0 7\n0 1 0\n3 0 1 2\n")),
            "m.ply:11: vertex 1: '7' is more than the row holds");
  EXPECT_EQ(problem(body("0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n")), "m.ply:12: vertex 2: nan is not finite");
  EXPECT_EQ(problem(body("0 0 0\n1 0 0\n0 1e400 0\n3 0 1 2\n")),
            "m.ply:12: vertex 2: inf is not finite, or was beyond single precision");
  EXPECT_EQ(problem(body("0 0 0\n1 0 0\n0 1,5 0\n3 0 1 2\n")),
            "m.ply:12: vertex 2: '1,5' is not a number of the kind that stands here");
  EXPECT_EQ(problem(body(three + "3 0 1 3\n")), "m.ply:13: face 0: index 3 is not one of 3 vertices");
  EXPECT_EQ(problem(body(three + "3 0 1 -1\n")), "m.ply:13: face 0: index -1 is not one of 3 vertices");
  EXPECT_EQ(problem(body(three + "255 0 1\n")), "m.ply:13: face 0: the row ends before all of its numbers");
  EXPECT_EQ(problem(body(three + "256 0 1\n")), "m.ply:13: face 0: '256' is no whole number from 0 to 255");
  EXPECT_EQ(problem(body(three)), "m.ply: the file ends after 0 of 1 rows of 'face'");
}

// Whatever the number becomes: part of a real column, one of its own, an index.
TEST(Ply, WholeNumbersOfATextLieWithinTheirType) {
  const auto row = [](const char* type, const std::string& z, const std::string& red,
                      const std::string& flag) {
    return fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty {0} z\n"
        "property {0} red\nproperty {0} green\nproperty {0} blue\nproperty {0} flag\nend_header\n"
        "0 0 {1} {2} 0 0 {3}\n",
        type, z, red, flag);
  };
  const std::string place = "m.ply:12: vertex 0: ";
  for (const char* wrong : {"256", "-1", "0.7", "1e2", "x"}) {
    const std::string said = fmt::format("{}'{}' is no whole number from 0 to 255", place, wrong);
    EXPECT_EQ(problem(row("uchar", wrong, "0", "0")), said);
    EXPECT_EQ(problem(row("uchar", "0", wrong, "0")), said);
    EXPECT_EQ(problem(row("uchar", "0", "0", wrong)), said);
  }
  EXPECT_EQ(problem(row("char", "128", "0", "0")), place + "'128' is no whole number from -128 to 127");
  EXPECT_EQ(problem(row("int", "0", "-2147483649", "0")),
            place + "'-2147483649' is no whole number from -2147483648 to 2147483647");
  EXPECT_EQ(problem(row("uint", "4294967296", "0", "0")),
            place + "'4294967296' is no whole number from 0 to 4294967295");
  EXPECT_EQ(values<glm::vec3>(read(row("char", "-128", "127", "0")).mesh, "position")[0].z, -128);
}

// A header that claims much more than there is takes no memory and says so.
TEST(Ply, ClaimsAreHeldAgainstTheBytes) {
  const auto claim = [](const char* format, const char* vertices, const char* face, const char* faces) {
    return fmt::format(
        "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
        "element face {}\nproperty list {} vertex_indices\nend_header\n",
        format, vertices, faces, face);
  };
  EXPECT_THAT(problem(claim("binary_little_endian", "2147483648", "uchar int", "0")),
              HasSubstr("2147483648 rows of 'vertex' need 12 bytes each at least, and 0 bytes are left"));
  EXPECT_THAT(problem(claim("binary_big_endian", "18446744073709551615", "uchar int", "0")),
              HasSubstr("are left"));
  EXPECT_THAT(problem(claim("ascii", "18446744073709551615", "uchar int", "0")),
              HasSubstr("the file ends after 0 of 18446744073709551615 rows of 'vertex'"));
  EXPECT_THAT(problem(claim("ascii", "99999999999999999999", "uchar int", "0")), HasSubstr("m.ply:3"));
  Bytes b;
  b.add(0xffffffffu);
  EXPECT_THAT(problem(claim("binary_little_endian", "0", "uint int", "1") + b.text),
              HasSubstr("ends within row 0 of 'face'"));
  EXPECT_THAT(problem(claim("binary_little_endian", "0", "int int", "1") + b.text),
              HasSubstr("row 0 of 'face' has a list of -1 numbers"));
}

TEST(Ply, EveryTruncationIsFound) {
  for (const std::string& whole : {binary<std::int32_t, std::uint8_t>(true, "int", "uchar"), square}) {
    const std::size_t last =
        whole.find_last_not_of('\n');  // the end of a text that begins with the last number
    for (std::size_t n = 0; n < last; ++n) EXPECT_NE(problem(whole.substr(0, n)), "") << n;
  }
}

TEST(Ply, TrailingBytesAreSaid) {
  EXPECT_THAT(read(square + "1 2 3\n").warnings, ElementsAre("normals_computed", "trailing_bytes"));
  EXPECT_THAT(read(binary<int, std::uint8_t>(false, "int", "uchar") + "x").warnings,
              ElementsAre("trailing_bytes", "properties_skipped"));
}

// Enough rows for many pieces, of both encodings.
std::string grid(bool binary, int n) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
      binary ? "binary_little_endian" : "ascii", n * n, (n - 1) * (n - 1));
  Bytes b;
  for (int i = 0; i < n * n; ++i) {
    const float x = 0.1f * static_cast<float>(i % n), y = 0.1f * static_cast<float>(i / n),
                z = std::sin(x * y);
    if (binary)
      b.add(x, y, z);
    else
      text += fmt::format("{} {} {}\n", x, y, z);
  }
  for (int j = 0; j + 1 < n; ++j)
    for (int i = 0; i + 1 < n; ++i) {
      const int a = j * n + i;
      if (binary)
        b.add(std::uint8_t{4}, a, a + 1, a + n + 1, a + n);
      else
        text += fmt::format("4 {} {} {} {}\n", a, a + 1, a + n + 1, a + n);
    }
  return text + b.text;
}

TEST(Ply, TextAndBinaryAndAnyNumberOfThreadsGiveTheSameBytes) {
  const std::string text = grid(false, 300), bytes = grid(true, 300);
  const auto digest = [](const std::string& s) {
    return Buffer(std::make_shared<const Mesh>(read(s).mesh)).digest();
  };
  const Digest first = digest(text);
  for (const int threads : {1, 2, 7}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
    EXPECT_EQ(digest(text), first);
    EXPECT_EQ(digest(bytes), first);
  }
}

TEST(Ply, AnErrorFarIntoAFileKnowsItsPlace) {
  std::string text = grid(false, 300);
  text.replace(text.rfind("4 "), 2, "x ");
  EXPECT_THAT(problem(text),
              HasSubstr(fmt::format("m.ply:{}: face {}:", 9 + 300 * 300 + 299 * 299, 299 * 299 - 1)));
}

TEST(Ply, JunkIsNeverMoreThanAMessage) {
  std::uint32_t state = 1;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const std::string& whole :
       {binary<std::int32_t, std::uint8_t>(true, "int", "uchar"), square, grid(true, 6)})
    for (int i = 0; i < 4000; ++i) {
      std::string text = whole;
      for (int k = 0; k < 1 + i % 3; ++k) text[random() % text.size()] = static_cast<char>(random());
      Context ctx;
      try {
        EXPECT_EQ(read_ply(text, {"m.ply", "m.ply"}, ctx).validate(), "");
      } catch (const NodeError&) {
      }
    }
}

}  // namespace
}  // namespace frustum
