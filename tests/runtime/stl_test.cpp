#include "runtime/io/stl.h"

#include "tests/support/mesh_text.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include <limits>

namespace frustum {
namespace {

using test::Bytes;
using test::values;
using testing::ElementsAre;
using testing::HasSubstr;

test::Reading read(std::string_view bytes) { return test::read_with(read_stl, bytes, "m.stl"); }
std::string problem(std::string_view bytes) { return test::problem_with(read_stl, bytes, "m.stl"); }

std::string facet(const char* normal, const char* a, const char* b, const char* c) {
  return fmt::format(
      " facet normal {}\n  outer loop\n   vertex {}\n   vertex {}\n   vertex {}\n  endloop\n endfacet\n",
      normal, a, b, c);
}
const std::string triangle = facet("0 0 1", "0 0 0", "1 0 0", "0 1 0");

struct Facet {
  glm::vec3 normal, a, b, c;
};
std::string binary(const std::vector<Facet>& facets, std::string header = "", std::uint16_t attributes = 0) {
  Bytes out;
  header.resize(80, ' ');
  out.text = header;
  out.add(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& f : facets) {
    for (const glm::vec3& v : {f.normal, f.a, f.b, f.c}) out.add(v.x, v.y, v.z);
    out.add(attributes);
  }
  return out.text;
}
const std::vector<Facet> tent{{{0, 0, 1}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                              {{0, 0, -1}, {1, 0, 0}, {-0.0f, 0, 0}, {0, 0, 1}},
                              {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 1, 0}}};

TEST(Stl, ColoursAreToldAsSkipped) {
  const auto told = [](const std::string& bytes) {
    Context ctx;
    read_stl(bytes, {"m.stl", "m.stl"}, ctx);
    return ctx.warnings().empty() ? std::string() : ctx.warnings()[0].second;
  };
  EXPECT_EQ(told(binary(tent)), "");
  EXPECT_EQ(told(binary(tent, "", 0xffff)),
            "m.stl: skipped the attribute bytes of 3 facets, which may be colours");
  EXPECT_EQ(
      told(binary(tent, "made by hand COLOR=\x01\x02\x03\xff", 0x100)),
      "m.stl: skipped the colour of its header and the attribute bytes of 3 facets, which may be colours");
}

TEST(Stl, WeldsCornersOfEqualBits) {
  const auto [m, warnings] = read(binary(tent));
  EXPECT_THAT(values<glm::vec3>(m, "position"),
              ElementsAre(glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)));
  EXPECT_THAT(values<glm::uvec3>(m, "triangle"),
              ElementsAre(glm::uvec3(0, 1, 2), glm::uvec3(1, 0, 3), glm::uvec3(0, 0, 2)));
  const auto n = values<glm::vec3>(m, "normal");
  EXPECT_EQ(n[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(n[3], glm::vec3(0, 1, 0));
  EXPECT_EQ(n[6], glm::vec3(0, 0, 1));  // no area
  EXPECT_EQ(m.at("normal").domain(), Domain::corner);
  EXPECT_THAT(warnings, testing::IsEmpty());
}

TEST(Stl, ABinaryFileMayBeginWithSolid) {
  const auto text = "solid thing\nfacet normal 0 0 1\n", bin = "solid made by a program";
  EXPECT_EQ(read(binary(tent, text)).mesh.faces(), 3u);
  EXPECT_EQ(read(binary(tent, bin)).mesh.faces(), 3u);
  EXPECT_THAT(read(binary(tent, bin) + "xyz").warnings, ElementsAre("trailing_bytes"));
  EXPECT_THAT(problem(binary(tent, bin).substr(0, 150)),
              "m.stl: byte 80: 3 facets of 50 bytes are claimed, and 66 bytes are left");
}

TEST(Stl, ReadsTextOfSeveralSolids) {
  const auto [m, warnings] =
      read("\xEF\xBB\xBFSOLID one two\n" + triangle + "endsolid one two\r\nsolid empty\nendsolid\nsolid\n" +
           triangle + "endsolid");
  EXPECT_EQ(m.faces(), 2u);
  EXPECT_EQ(m.vertices(), 3u);
  EXPECT_THAT(values<std::uint32_t>(m, "group"), ElementsAre(0, 1));
  EXPECT_THAT(warnings, testing::IsEmpty());
  EXPECT_EQ(read("solid a\n" + triangle + "endsolid a\n").mesh.find("group"), nullptr);
}

TEST(Stl, NormalsAgainstTheWindingAreCounted) {
  const auto [m, warnings] = read("solid a\n" + facet("0 0 -3", "0 0 0", "1 0 0", "0 1 0") +
                                  facet("nan nan nan", "0 0 0", "1 0 0", "0 1 0") + "endsolid\n");
  EXPECT_THAT(warnings, ElementsAre("facet_normals"));
  EXPECT_EQ(values<glm::vec3>(m, "normal"), std::vector<glm::vec3>(6, {0, 0, 1}));
}

TEST(Stl, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(problem(""), HasSubstr("neither"));
  EXPECT_THAT(problem("hello"), HasSubstr("neither"));
  EXPECT_EQ(problem("solid a\n" + triangle),
            "m.stl:9: the file ends where 'facet' or 'endsolid' is expected");
  EXPECT_EQ(problem("solid a\n" + facet("0 0 1", "0 0 0", "1 0 inf", "0 1 0") + "endsolid\n"),
            "m.stl:5: 'inf' stands where a finite number is expected");
  EXPECT_EQ(problem("solid a\n" + facet("0 0 1", "0 0 0", "1 0 1e99", "0 1 0") + "endsolid\n"),
            "m.stl:5: '1e99' stands where a number of single precision is expected");
  EXPECT_EQ(problem("solid a\n" + facet("0 0 1", "0 0 0", "1 0", "0 1 0") + "endsolid\n"),
            "m.stl:6: 'vertex' stands where a finite number is expected");
  EXPECT_EQ(problem("solid a\nfacet normals 0 0 1\n"),
            "m.stl:2: 'normals' stands where 'normal' is expected");
  auto broken = tent;
  broken[1].b.y = std::numeric_limits<float>::quiet_NaN();
  broken[2].c.y = std::numeric_limits<float>::infinity();
  EXPECT_EQ(problem(binary(broken)), "m.stl: byte 134: facet 1 has a corner that is not finite");
  std::string huge = binary(tent);
  huge.replace(80, 4, "\xff\xff\xff\xff");
  EXPECT_EQ(problem(huge),
            "m.stl: byte 80: 4294967295 facets of 50 bytes are claimed, and 150 bytes are left");
}

TEST(Stl, EveryTruncationOfATextIsFound) {
  const std::string whole = "solid a\n" + triangle + triangle + "endsolid";
  for (std::size_t n = 0; n < whole.size(); ++n) EXPECT_NE(problem(whole.substr(0, n)), "") << n;
}

TEST(Stl, AnEmptySolidIsAMeshWithoutFaces) {
  const auto [m, warnings] = read("solid\nendsolid\n");
  EXPECT_EQ(m.faces(), 0u);
  EXPECT_THAT(warnings, ElementsAre("no_faces"));
  EXPECT_THAT(read(binary({})).warnings, ElementsAre("no_faces"));
}

TEST(Stl, AnyNumberOfThreadsGivesTheSameBytes) {
  std::vector<Facet> facets;
  std::uint32_t state = 7;
  const auto random = [&] { return static_cast<float>((state = state * 1664525u + 1013904223u) >> 28); };
  const auto point = [&] { return glm::vec3(random(), random(), random()); };
  for (int i = 0; i < 40000; ++i) facets.push_back({{0, 0, 0}, point(), point(), point()});
  const std::string bytes = binary(facets);
  const auto m = read(bytes).mesh;
  EXPECT_EQ(m.vertices(), 4096u);  // every point of a 16 x 16 x 16 lattice, once
  const auto p = values<glm::vec3>(m, "position");
  for (std::size_t f = 0; f < facets.size(); ++f) EXPECT_EQ(p[m.triangles()[f].y], facets[f].b);
  for (const std::size_t threads : {1U, 2U, 7U}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    EXPECT_EQ(Buffer(std::make_shared<const Mesh>(read(bytes).mesh)).digest(),
              Buffer(std::make_shared<const Mesh>(m)).digest());
  }
}

TEST(Stl, JunkIsNeverMoreThanAMessage) {
  std::uint32_t state = 1;
  const auto random = [&] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const std::string& whole : {binary(tent), "solid a\n" + triangle + "endsolid a\n"})
    for (int i = 0; i < 4000; ++i) {
      std::string text = whole;
      for (int k = 0; k < 1 + i % 3; ++k) text[random() % text.size()] = static_cast<char>(random());
      Context ctx;
      try {
        EXPECT_EQ(read_stl(text, {"m.stl", "m.stl"}, ctx).validate(), "");
      } catch (const NodeError&) {
      }
    }
}

}  // namespace
}  // namespace frustum
