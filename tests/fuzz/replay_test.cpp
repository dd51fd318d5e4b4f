// What fuzzing has found of interest, read again by this build: the inputs that together reach the most code, and
// those that once were findings.
#include "tests/fuzz/support/check.h"
#include "tests/fuzz/support/target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace frustum::fuzz {
namespace {

namespace fs = std::filesystem;

const fs::path& root() {
  static const fs::path path = fs::path(FRUSTUM_SOURCE_DIR) / "tests" / "fuzz";
  return path;
}

std::vector<fs::path> kept(const char* kind, std::string_view target) {
  std::vector<fs::path> out;
  if (!fs::exists(root() / kind / target)) return out;
  for (const auto& entry : fs::directory_iterator(root() / kind / target)) out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

// Exactly as long as the file, so that a sanitizer sees a read beyond its end.
std::vector<char> bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

class FuzzReplay : public testing::TestWithParam<Target> {};

TEST_P(FuzzReplay, ReadsEveryInputThatIsKept) {
  std::vector<fs::path> inputs = kept("corpus", GetParam().name);
  ASSERT_FALSE(inputs.empty()) << "./dev fuzz --keep " << GetParam().name << " gathers some";
  for (fs::path& found : kept("regressions", GetParam().name)) inputs.push_back(std::move(found));
  for (const fs::path& input : inputs) {
    const std::vector<char> bytes = bytes_of(input);
    const std::clock_t start = std::clock();
    EXPECT_NO_THROW(GetParam().read({bytes.data(), bytes.size()})) << input;
    // The fuzzers' own limit, of processor time: what takes 2 s for some hundred bytes is not slow but stuck.
    EXPECT_LT(std::clock() - start, 2 * CLOCKS_PER_SEC) << input;
  }
}

TEST_P(FuzzReplay, TakesNothingForAnInput) { EXPECT_NO_THROW(GetParam().read({})); }

INSTANTIATE_TEST_SUITE_P(Targets, FuzzReplay, testing::ValuesIn(targets()),
                         [](const auto& info) { return std::string(info.param.name); });

TEST(Fuzz, EveryFileIsATargetOfItsName) {
  std::set<std::string> files, names;
  for (const auto& entry : fs::directory_iterator(root()))
    if (const std::string stem = entry.path().stem().string();
        entry.path().extension() == ".cpp" && !stem.ends_with("_test"))
      files.insert(stem);
  for (const Target& target : targets()) names.insert(std::string(target.name));
  EXPECT_EQ(files, names);
}

TEST(Fuzz, KeepsNoInputsOfATargetThatIsGone) {
  for (const char* kind : {"corpus", "regressions"}) {
    if (!fs::exists(root() / kind)) continue;
    for (const auto& folder : fs::directory_iterator(root() / kind))
      EXPECT_TRUE(fs::exists(root() / (folder.path().filename().string() + ".cpp"))) << folder.path();
  }
}

// A mesh of one triangle whose columns the body may spoil.
template <class Body>
void expect_finding(const std::string& what, const Body& spoil) {
  auto triangle = Column::make<glm::uvec3>("triangle", Domain::face, 1);
  auto position = Column::make<glm::vec3>("position", Domain::vertex, 3, Space::object);
  auto normal = Column::make<glm::vec3>("normal", Domain::vertex, 3);
  triangle->values<glm::uvec3>()[0] = {0, 1, 2};
  for (std::size_t i = 0; i < 3; ++i) {
    position->values<glm::vec3>()[i] = {i == 1, i == 2, 0};
    normal->values<glm::vec3>()[i] = {0, 0, 1};
  }
  Mesh whole;
  whole.columns = {triangle, position, normal};
  ASSERT_NO_THROW(check_mesh(whole));
  spoil(*triangle, *position, *normal);
  try {
    check_mesh(whole);
    ADD_FAILURE() << "this was not found: " << what;
  } catch (const Finding& finding) {
    EXPECT_EQ(finding.what(), what);
  }
}

TEST(Fuzz, FindsMeshesThatBreakTheirLaws) {
  expect_finding("face 0 names a vertex beyond the 3 there are",
                 [](Column& triangle, Column&, Column&) { triangle.values<glm::uvec3>()[0].y = 3; });
  expect_finding("position 1 is not finite",
                 [](Column&, Column& position, Column&) { position.values<glm::vec3>()[1].z = NAN; });
  expect_finding("normal 2 has length 2",
                 [](Column&, Column&, Column& normal) { normal.values<glm::vec3>()[2].z = 2; });
}

TEST(Fuzz, FindsProblemsThatDoNotNameTheirFile) {
  const FilePath file{"input.ply", "input.ply"};
  EXPECT_NO_THROW(reading(file, [](Context&) { throw NodeError("malformed_file", "input.ply:3: no"); }));
  EXPECT_THROW(reading(file, [](Context&) { throw NodeError("malformed_file", "line 3: no"); }), Finding);
  EXPECT_THROW(reading(file, [](Context&) { throw WorldError("out_of_memory", "input.ply: no"); }), Finding);
  EXPECT_THROW(reading(file, [](Context& ctx) { ctx.warn("Faces", "input.ply: no"); }), Finding);
  EXPECT_THROW(reading(file, [](Context&) { throw std::out_of_range("vector"); }), std::out_of_range);
}

}  // namespace
}  // namespace frustum::fuzz
