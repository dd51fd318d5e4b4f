// Nodes that make many rows of little ask for their memory before they take it.
#include "nodes/clip.h"
#include "nodes/cull.h"
#include "nodes/io.h"
#include "nodes/mesh.h"
#include "nodes/project.h"
#include "nodes/scene.h"
#include "nodes/surface.h"
#include "runtime/buffers/mesh.h"
#include "tests/support/run_node.h"
#include "tests/support/source_dir.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <functional>
#include <string>

namespace frustum {
namespace {

constexpr std::uint64_t limit = std::uint64_t{64} << 20;

// The greatest address space that this process had, in bytes.
std::uint64_t peak_address_space() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmPeak:")) return std::stoull(line.substr(7)) << 10;
  return 0;
}

struct Case {
  const char* name;
  std::function<NodeType()> type;
  Json params;
  std::function<test::NodeInputs()> inputs;
};

Buffer ball() { return test::run_node(nodes::mesh_sphere(), {{"segments", 256}, {"rings", 128}})[0]; }
Buffer teapot() {
  return test::run_node(nodes::io_load_patches(), {{"file", "graphs/data/teapot.json"}}, {}, nullptr,
                        FRUSTUM_SOURCE_DIR)[0];
}
test::NodeInputs none() { return {}; }

// Each would take more than 8 GB.
std::vector<Case> cases() {
  const Json placements(4096, Json::object());
  return {{"sphere", nodes::mesh_sphere, {{"segments", 16384}, {"rings", 16384}}, none},
          {"torus", nodes::mesh_torus, {{"segments", 16384}, {"sides", 16384}}, none},
          {"grid", nodes::mesh_grid, {{"segments", {16384, 16384}}}, none},
          {"instance",
           nodes::mesh_instance,
           {{"placements", placements}},
           [] { return test::NodeInputs{{ball()}}; }},
          {"merge", nodes::mesh_merge, Json::object(),
           [] { return test::NodeInputs{std::vector<Buffer>(4096, ball())}; }},
          {"tessellate", nodes::surface_tessellate, {{"min_segments", 4096}, {"max_segments", 4096}}, [] {
             return test::NodeInputs{{teapot()}};
           }}};
}

TEST(MeshMemory, MoreThanTheRunMayHaveIsRefusedBeforeItIsTaken) {
  for (const Case& c : cases()) {
    const test::NodeInputs inputs = c.inputs();
    Context ctx;
    ctx.admit = [](std::uint64_t all) {
      if (all > limit) throw NodeError("memory", "too much");
    };
    const std::uint64_t before = peak_address_space();
    try {
      test::run_node(c.type(), c.params, inputs, &ctx);
      ADD_FAILURE() << c.name;
    } catch (const NodeError& e) {
      EXPECT_EQ(e.code, "memory") << c.name;
    }
    EXPECT_GT(ctx.claimed(), std::uint64_t{2} << 30) << c.name;
    EXPECT_LT(peak_address_space(), before + (std::uint64_t{1} << 30)) << c.name;
  }
}

// What is claimed is what the columns hold, and for nodes that sort or join not less.
TEST(MeshMemory, ClaimsAreOfTheSizeOfWhatIsMade) {
  const Buffer from = ball();
  const auto made = [](const NodeType& type, const Json& params, const test::NodeInputs& in) {
    Context ctx;
    const auto mesh = test::run_node(type, params, in, &ctx)[0].as<Mesh>();
    std::uint64_t bytes = 0;
    for (const auto& c : mesh->columns) bytes += c->bytes();
    return std::pair(static_cast<double>(ctx.claimed()), static_cast<double>(bytes));
  };
  for (const auto& [type, params, in] : std::vector<std::tuple<NodeType, Json, test::NodeInputs>>{
           {nodes::mesh_sphere(), Json::object(), {}},
           {nodes::mesh_torus(), Json::object(), {}},
           {nodes::mesh_grid(), {{"segments", {30, 20}}}, {}},
           {nodes::mesh_merge(), Json::object(), {{from, from}}},
           {nodes::mesh_instance(), {{"placements", {Json::object(), Json::object()}}}, {{from}}}}) {
    const auto [claimed, bytes] = made(type, params, in);
    EXPECT_EQ(claimed, bytes) << type.name;
  }
  const double own = static_cast<double>(from.as<Mesh>()->faces()) * 3 * sizeof(glm::vec3);
  EXPECT_GE(made(nodes::mesh_normals(), Json::object(), {{from}}).first, own);
  EXPECT_GE(made(nodes::mesh_weld(), Json::object(), {{from}}).first,
            made(nodes::mesh_weld(), Json::object(), {{from}}).second);
  const auto [claimed, bytes] = made(nodes::surface_tessellate(), Json::object(), {{teapot()}});
  EXPECT_GE(claimed, bytes);
  EXPECT_LE(claimed, 3 * bytes);
}

// Columns that are shared with the input cost nothing.
std::uint64_t bytes_of_new_columns(const Mesh& before, const Mesh& after) {
  std::uint64_t sum = 0;
  for (const auto& c : after.columns) {
    const bool shared = std::any_of(before.columns.begin(), before.columns.end(),
                                    [&](const auto& old) { return old->data() == c->data(); });
    sum += shared ? 0 : c->bytes();
  }
  return sum;
}

TEST(MeshMemory, OnTheWayToTheScreenNothingIsTakenThatWasNotAskedFor) {
  // The ball passes through the near plane and the sides of the view.
  const Buffer camera =
      test::run_node(nodes::scene_camera(), {{"eye", {0, 0, 3}}, {"target", {0.5, 0, 0}}, {"near", 2.5}})[0];
  Buffer mesh = ball();
  struct Step {
    NodeType type;
    bool sees;  // whether it takes the camera
  };
  for (const Step& step : {Step{nodes::project_view(), true}, Step{nodes::project_perspective(), true},
                           Step{nodes::cull_frustum(), false}, Step{nodes::clip_homogeneous(), false},
                           Step{nodes::cull_backface(), false}, Step{nodes::project_viewport(), true}}) {
    Context ctx;
    test::NodeInputs in{{mesh}};
    if (step.sees) in.push_back({camera});
    const Buffer out = test::run_node(step.type, Json::object(), in, &ctx)[0];
    const std::uint64_t made = bytes_of_new_columns(*mesh.as<Mesh>(), *out.as<Mesh>());
    EXPECT_GT(made, 0u) << step.type.name;
    EXPECT_GE(ctx.claimed(), made) << step.type.name;
    mesh = out;
  }
}

}  // namespace
}  // namespace frustum
