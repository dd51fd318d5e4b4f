#include "nodes/io/load_scene.h"

#include "nodes/io.h"
#include "runtime/buffers/mesh.h"
#include "runtime/core/node_type.h"
#include "runtime/io/gltf.h"
#include "tests/support/gltf_maker.h"
#include "tests/support/run_node.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <cmath>

namespace frustum {
namespace {

using testing::HasSubstr;

const std::string data_folder = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data";

TEST(LoadScene, GivesMeshCameraAndLightsOfTheStillLife) {
  const auto out = test::run_node(nodes::io_load_scene(),
                                  {{"file", "still_life.glb"}, {"camera", "front"}, {"resolution", {64, 36}}},
                                  {}, nullptr, data_folder);
  const auto mesh = out.at(0).as<Mesh>();
  ASSERT_EQ(mesh->validate(), "");
  EXPECT_EQ(mesh->space(), Space::world);
  ASSERT_EQ(mesh->materials->materials.size(), 6u);
  EXPECT_EQ(std::count_if(mesh->materials->materials.begin(), mesh->materials->materials.end(),
                          [](const Material& m) { return m.texture != nullptr; }),
            3);
  const auto camera = out.at(1).as<Camera>();
  EXPECT_EQ(camera->resolution, glm::ivec2(64, 36));
  EXPECT_NEAR(camera->eye.z, 5.4, 1e-12);
  EXPECT_EQ(out.at(2).as<LightSet>()->lights.size(), 3u);
}

TEST(LoadScene, AFileWithoutCameraAndLightsIsSeenWhole) {
  test::TempFolder folder;
  folder.write("t.glb", test::one_triangle().glb());
  const auto out = test::run_node(nodes::io_load_scene(), {{"file", "t.glb"}, {"resolution", {100, 200}}}, {},
                                  nullptr, folder.path());
  const auto camera = out.at(1).as<Camera>();
  const glm::dvec3 forward = kernels::normalized_or(camera->target - camera->eye, glm::dvec3(0));
  const double tan_half = std::tan(camera->fov_y / 2);
  for (const glm::dvec3 corner : {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)}) {
    const glm::dvec3 d = corner - camera->eye;
    const double along = kernels::dot(d, forward), beside = std::sqrt(kernels::dot(d, d) - along * along);
    EXPECT_LT(beside / along, tan_half * camera->aspect());
    EXPECT_GT(along, camera->near_z);
    EXPECT_LT(along, camera->far_z);
  }
  EXPECT_EQ(out.at(2).as<LightSet>()->lights.size(), 2u);
}

TEST(LoadScene, AnEmptyBoxStillHasACamera) {
  const Camera c = fitted_camera(glm::dvec3(2), glm::dvec3(2), {16, 16});
  EXPECT_EQ(c.target, glm::dvec3(2));
  EXPECT_GT(c.near_z, 0);
  EXPECT_LT(c.near_z, c.far_z);
}

TEST(LoadScene, NamesTheCamerasThereAre) {
  const auto [code, message] = test::run_error(
      nodes::io_load_scene(), {{"file", "still_life.glb"}, {"camera", "frnt"}}, {}, data_folder);
  EXPECT_EQ(code, "unknown_camera");
  EXPECT_THAT(message, HasSubstr("it has 1: \"front\""));
}

TEST(LoadScene, TheCacheKeyFollowsTheFilesThatTheFileNames) {
  test::TempFolder folder;
  nlohmann::json document = test::one_triangle().document;
  document["buffers"] = {{{"uri", "t.bin"}, {"byteLength", 36}}};
  folder.write("t.gltf", document.dump());
  const NodeType type = nodes::io_load_scene();
  const auto params = type.default_params();
  Diagnostics problems;
  ParamReader reader(problems, "", folder.path());
  read_record(type.params, {{"file", "t.gltf"}}, params.get(), reader);
  std::vector<std::string> files;
  type.params.files(params.get(), [&](const FilePath& f) { files.push_back(f.resolved); });
  EXPECT_THAT(files, testing::ElementsAre(folder.file("t.gltf"), folder.file("t.bin")));
}

}  // namespace
}  // namespace frustum
