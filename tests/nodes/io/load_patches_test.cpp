#include "nodes/io/load_patches.h"

#include "nodes/io.h"
#include "tests/support/run_node.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <set>

namespace frustum {
namespace {

using testing::HasSubstr;

const std::string data = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data";

Surface teapot() {
  const auto out = test::run_node(nodes::io_load_patches(), {{"file", "teapot.json"}}, {}, nullptr, data);
  return *out.at(0).as<Surface>();
}

using Edge = std::array<std::uint32_t, 4>;

// The four boundary rows of a patch, each in the direction that makes equal rows equal.
std::array<Edge, 4> boundaries(const std::array<std::uint32_t, 16>& p) {
  std::array<Edge, 4> all{Edge{p[0], p[1], p[2], p[3]}, Edge{p[12], p[13], p[14], p[15]},
                          Edge{p[0], p[4], p[8], p[12]}, Edge{p[3], p[7], p[11], p[15]}};
  for (Edge& e : all) e = std::min(e, Edge{e[3], e[2], e[1], e[0]});
  return all;
}

TEST(LoadPatches, TeapotHas32PatchesAndEveryPointOnce) {
  const Surface s = teapot();
  EXPECT_EQ(s.patches.size(), 32u);
  EXPECT_EQ(s.points.size(), 290u);
  std::set<std::array<double, 3>> distinct;
  double top = 0, bottom = 1;
  for (const glm::dvec3& p : s.points) {
    distinct.insert({p.x, p.y, p.z});
    top = std::max(top, p.z), bottom = std::min(bottom, p.z);
  }
  EXPECT_EQ(distinct.size(), s.points.size());
  EXPECT_EQ(top, 3.15);
  EXPECT_EQ(bottom, 0);
  EXPECT_EQ(s.space, Space::object);
}

// 16 open boundaries: 4 each of rim, lid, and 2 at each end of handle and spout; two poles are shared by
// four patches.
TEST(LoadPatches, TeapotSharesBoundariesByIndex) {
  std::map<Edge, int> uses;
  for (const auto& patch : teapot().patches)
    for (const Edge& e : boundaries(patch)) ++uses[e];
  std::map<int, int> histogram;
  for (const auto& [edge, n] : uses) ++histogram[n];
  EXPECT_EQ(histogram, (std::map<int, int>{{1, 16}, {2, 52}, {4, 2}}));
}

// Of the body (patches 4 to 11), whose axis is z: dP/du x dP/dv at (1/2, 1/2) leaves the axis.
TEST(LoadPatches, TeapotPatchesFaceOutwards) {
  const Surface s = teapot();
  constexpr std::array<double, 4> value{0.125, 0.375, 0.375, 0.125}, slope{-0.75, -0.75, 0.75, 0.75};
  for (std::size_t k = 4; k < 12; ++k) {
    glm::dvec3 p{0}, du{0}, dv{0};
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        const glm::dvec3 c = s.points[s.patches[k][4 * i + j]];
        p += value[i] * value[j] * c, du += slope[i] * value[j] * c, dv += value[i] * slope[j] * c;
      }
    const glm::dvec3 n = glm::cross(du, dv);
    EXPECT_GT(n.x * p.x + n.y * p.y, 0) << "patch " << k;
  }
}

TEST(LoadPatches, NoPatchesAreAnEmptySurface) {
  EXPECT_TRUE(
      parse_patches(R"({"format": "frustum.patches/1", "points": [], "patches": []})", "x").patches.empty());
}

std::string problem(const std::string& text) {
  const test::TempFolder folder;
  folder.write("p.json", text);
  const auto [code, message] =
      test::run_error(nodes::io_load_patches(), {{"file", "p.json"}}, {}, folder.path());
  EXPECT_EQ(code, "malformed_file");
  return message;
}

std::string file_with(const std::string& points, const std::string& patches) {
  return R"({"format": "frustum.patches/1", "points": )" + points + R"(, "patches": )" + patches + "}";
}

TEST(LoadPatches, SaysWhatIsWrongAndWhere) {
  EXPECT_THAT(problem("{\n\"points\": [1,\n"), HasSubstr("p.json:3: this is not JSON"));
  EXPECT_THAT(problem(""), HasSubstr("p.json:1: this is not JSON"));
  EXPECT_THAT(problem("[]"), HasSubstr("must be an object"));
  EXPECT_THAT(problem(R"({"format": "frustum.patches/2", "points": [], "patches": []})"),
              HasSubstr("/format: this must be"));
  EXPECT_THAT(problem(R"({"format": "frustum.patches/1", "patches": []})"),
              HasSubstr("there is no \"points\""));
  EXPECT_THAT(problem(R"({"format": "frustum.patches/1", "pionts": []})"),
              HasSubstr("\"pionts\" is not a key"));
  EXPECT_THAT(problem(file_with("[[1, 2]]", "[]")), HasSubstr("/points/0: a point is an array of 3 numbers"));
  EXPECT_THAT(problem(file_with("[[1, 2, null]]", "[]")), HasSubstr("/points/0/2: this must be a number"));
  EXPECT_THAT(problem(file_with("[[1, 2, 1e999]]", "[]")), HasSubstr("too large"));
  EXPECT_THAT(problem(file_with("[[1, 2, 3]]", "[[0]]")),
              HasSubstr("/patches/0: a patch is an array of 16 indices"));
  EXPECT_THAT(problem(file_with("[[1, 2, 3]]", "[[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1]]")),
              HasSubstr("/patches/0/15: 1 is not the index of one of the 1 points"));
  EXPECT_THAT(problem(file_with("[[1, 2, 3]]", "[[0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,-1]]")),
              HasSubstr("-1 is not the index"));
  EXPECT_THAT(problem(std::string(100'000, '[')), HasSubstr("not JSON"));
}

TEST(LoadPatches, AFileThatIsNotThereIsAnErrorOfTheWorld) {
  const test::TempFolder folder;
  const auto missing = test::run_error(nodes::io_load_patches(), {{"file", "none.json"}}, {}, folder.path());
  EXPECT_EQ(missing.first, "cannot_read_file");
  EXPECT_THAT(missing.second, HasSubstr("cannot read none.json: No such file"));
  EXPECT_EQ(test::run_error(nodes::io_load_patches(), {{"file", "."}}, {}, folder.path()).first,
            "cannot_read_file");
  EXPECT_EQ(test::run_error(nodes::io_load_patches(), Json::object()).first, "no_file");
}

}  // namespace
}  // namespace frustum
