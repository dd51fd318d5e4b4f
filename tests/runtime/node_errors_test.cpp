// What a node says is wrong stands where the user wrote it: at the parameter or at the link, before the run where that can
// be known.
#include "runtime/app/session.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace frustum {
namespace {

Diagnostic only_error(const Diagnostics& problems) {
  std::vector<Diagnostic> errors;
  for (const Diagnostic& d : problems.list())
    if (d.severity == Severity::error) errors.push_back(d);
  EXPECT_EQ(errors.size(), 1u) << to_text(problems);
  return errors.empty() ? Diagnostic{} : errors.front();
}

struct Ends {
  Loaded loaded;
  RunResult result;
};

// Loads a graph of these nodes, runs what nobody reads in it, and looks at both.
Ends run_text(const std::string& nodes, std::vector<Setting> settings = {}, RunOptions options = {}) {
  const Session session;
  LoadOptions load;
  load.settings = std::move(settings);
  Ends ends{load_graph_text("{ \"format\": \"frustum.graph/1\",\n  \"nodes\": {\n" + nodes + " } }", "g.json",
                            session.registry(), load),
            {}};
  if (!ends.loaded.graph) return ends;
  options.demand.ports = end_ports(*ends.loaded.graph);
  ends.result = run_graph(*ends.loaded.graph, options);
  return ends;
}

TEST(NodeErrors, ParametersThatDoNotFitTogetherAreFoundWhenTheGraphIsLoaded) {
  const struct {
    const char *nodes, *code, *pointer;
  } cases[] = {
      {R"("sun": { "type": "light.directional", "params": { "direction": [0, 0, 0] } })", "zero_direction",
       "/nodes/sun/params/direction"},
      {R"("eye": { "type": "scene.camera", "params": { "near": 2, "far": 1 } })", "impossible_camera",
       "/nodes/eye/params/far"},
      {R"("eye": { "type": "scene.camera", "params": { "eye": [1, 2, 3], "target": [1, 2, 3] } })",
       "impossible_camera", "/nodes/eye/params/target"},
      {R"("lamp": { "type": "light.point", "params": { "attenuation": [0, 0, 0] } })", "bad_attenuation",
       "/nodes/lamp/params/attenuation"},
      {R"("box": { "type": "mesh.box" }, "turn": { "type": "transform.affine", "in": { "geometry": "box" },
          "params": { "steps": [{ "translate": [1, 0, 0] }, { "scale": [1, 0, 1] }] } })",
       "singular_transform", "/nodes/turn/params/steps/1"},
      {R"("many": { "type": "mesh.instance", "in": { "mesh": { "value": 1 } },
          "params": { "placements": [{ "scale": [0, 1, 1] }] } })",
       "singular_transform", "/nodes/many/params/placements/0"},
      {R"("model": { "type": "io.load_mesh", "params": { "file": "model.max" } })", "unknown_format",
       "/nodes/model/params/file"},
      {R"("model": { "type": "io.load_mesh" })", "no_file", "/nodes/model"},
      {R"("model": { "type": "io.load_scene", "params": { "file": "" } })", "no_file",
       "/nodes/model/params/file"},
      {R"("card": { "type": "io.load_image", "params": { "file": "a.png", "space": "srbg" } })",
       "unknown_color_space", "/nodes/card/params/space"},
  };
  for (const auto& c : cases) {
    const Ends ends = run_text(c.nodes);
    ASSERT_FALSE(ends.loaded.graph) << c.nodes;
    const auto& all = ends.loaded.problems.list();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Diagnostic& d) { return d.code == c.code; });
    ASSERT_NE(found, all.end()) << c.nodes << to_text(ends.loaded.problems);
    EXPECT_EQ(found->pointer, c.pointer);
    EXPECT_GE(found->line, 3);
  }
}

TEST(NodeErrors, AColourSpaceIsLookedUpWhenTheGraphIsLoaded) {
  const Ends ends = run_text(R"("in": { "type": "io.load_image", "params": { "file": "a.png" } },
    "out": { "type": "color.convert", "in": { "image": "in" }, "params": { "to": "srbg" } })");
  const Diagnostic d = only_error(ends.loaded.problems);
  EXPECT_EQ(d.code, "unknown_color_space");
  EXPECT_EQ(d.pointer, "/nodes/out/params/to");
  EXPECT_EQ(d.line, 4);
  EXPECT_THAT(d.message, testing::HasSubstr("srgb"));
}

TEST(NodeErrors, AValueFromOutsideIsNamedAsSuch) {
  const Ends ends =
      run_text(R"("eye": { "type": "scene.camera", "params": { "far": 5 } })", {{"eye:near", "9"}});
  const Diagnostic d = only_error(ends.loaded.problems);
  EXPECT_EQ(d.code, "impossible_camera");
  EXPECT_EQ(d.pointer, "/nodes/eye/params/far");
}

TEST(NodeErrors, AParameterThatCouldNotBeReadIsTheOnlyProblem) {
  const Ends ends = run_text(R"("eye": { "type": "scene.camera", "params": { "near": 2, "far": "x" } })");
  EXPECT_EQ(only_error(ends.loaded.problems).code, "wrong_type");
}

TEST(NodeErrors, WhatOnlyARunFindsStandsAtTheParameterOrTheLink) {
  const Ends material = run_text(R"("box": { "type": "mesh.box" }, "clay": { "type": "shade.material" },
    "red": { "type": "mesh.assign_material", "in": { "mesh": "box", "material": "clay" },
             "params": { "instead_of": "gold" } })");
  ASSERT_TRUE(material.loaded.graph) << to_text(material.loaded.problems);
  EXPECT_EQ(material.result.end, RunResult::End::failed);
  Diagnostic d = only_error(material.result.problems);
  EXPECT_EQ(d.code, "unknown_material");
  EXPECT_EQ(d.pointer, "/nodes/red/params/instead_of");
  EXPECT_EQ(d.line, 5);

  const Ends empty = run_text(R"("none": { "type": "mesh.box" },
    "far": { "type": "mesh.assign_material", "in": { "mesh": "none", "material": "clay" } },
    "clay": { "type": "shade.material" }, "camera": { "type": "scene.camera" },
    "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "clip", "camera": "camera" } },
    "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "eye": { "type": "project.view", "in": { "mesh": "far", "camera": "camera" } },
    "light": { "type": "light.ambient" },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "lit": { "type": "shade.surface", "in": { "points": "points", "mesh": "none", "lights": ["light"] },
             "params": { "interpolation": "gouraud" } })");
  ASSERT_TRUE(empty.loaded.graph) << to_text(empty.loaded.problems);
  d = only_error(empty.result.problems);
  EXPECT_THAT(d.pointer, testing::StartsWith("/nodes/lit/in/")) << d.message;
}

TEST(NodeErrors, WhatHappensInsideAGraphUsedAsANodeNamesItsUse) {
  const test::TempFolder folder;
  folder.write("inner.json", R"({ "format": "frustum.graph/1", "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "none.obj" } } }, "outputs": { "mesh": { "from": "m" } } })");
  const std::string path = folder.write("outer.json", R"({ "format": "frustum.graph/1", "nodes": {
    "first": { "type": "graph", "file": "inner.json" } }, "outputs": { "mesh": { "from": "first" } } })");
  Session session;
  folder.write("none.obj", "v 0 0 nothing");
  const Loaded loaded = session.load(path);
  ASSERT_TRUE(loaded.graph) << to_text(loaded.problems);
  const RunResult r = session.run(*loaded.graph, {.demand = {.ports = end_ports(*loaded.graph)}});
  EXPECT_EQ(r.end, RunResult::End::failed);
  const Diagnostic d = only_error(r.problems);
  EXPECT_EQ(d.code, "malformed_file");
  EXPECT_EQ(d.pointer, "/nodes/m/params/file") << "the parameter that names the file";
  EXPECT_THAT(d.message, testing::HasSubstr("(at 'first/m')"));
}

// It is there when the graph is loaded, and gone or closed when the node reads it.
TEST(NodeErrors, AFileThatCannotBeReadIsTheWorldsFailure) {
  const test::TempFolder folder;
  const std::string path = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "short.obj" } } } })");
  folder.write("short.obj", "v 0 0 0");
  Session session;
  const Loaded loaded = session.load(path);
  ASSERT_TRUE(loaded.graph) << to_text(loaded.problems);
  std::filesystem::remove(folder.file("short.obj"));
  const RunResult r = session.run(*loaded.graph, {.demand = {.ports = end_ports(*loaded.graph)}});
  EXPECT_EQ(r.end, RunResult::End::world_failed);
  const Diagnostic d = only_error(r.problems);
  EXPECT_EQ(d.code, "cannot_read_file");
  EXPECT_EQ(d.pointer, "/nodes/m/params/file");
  EXPECT_EQ(d.column, 56) << "the value, and not its key";
}

TEST(NodeErrors, AFrameOfASeriesIsNotSetByHandAsWell) {
  const Session session;
  LoadOptions load{.settings = {{"frame", "9"}}};
  load.frame = 1;
  const Loaded loaded =
      load_graph_text(R"({ "format": "frustum.graph/1", "params": { "frame": 1 }, "nodes": {} })", "g.json",
                      session.registry(), load);
  EXPECT_EQ(only_error(loaded.problems).code, "frame_set_twice");
}

constexpr auto frame_of_many_samples = R"("box": { "type": "mesh.box" },
    "camera": { "type": "scene.camera", "params": { "resolution": [64, 64] } },
    "eye": { "type": "project.view", "in": { "mesh": "box", "camera": "camera" } },
    "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } },
    "screen": { "type": "project.viewport", "in": { "mesh": "clip", "camera": "camera" } },
    "pattern": { "type": "supersample.pattern", "params": { "samples": 1024 } },
    "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen", "pattern": "pattern" } },
    "points": { "type": "rasterize.attributes", "in": { "hits": "hits", "mesh": "screen" } },
    "light": { "type": "light.ambient" },
    "lit": { "type": "shade.surface", "in": { "points": "points", "mesh": "screen", "lights": ["light"] } },
    "pixels": { "type": "supersample.resolve", "in": { "image": "lit" } })";

// 1024 samples, whose weights are a table for every place in the pattern's period.
TEST(NodeErrors, MemoryOfPreparedNodesCounts) {
  const Ends free = run_text(frame_of_many_samples);
  ASSERT_EQ(free.result.end, RunResult::End::done) << to_text(free.result.problems);
  EXPECT_GT(free.result.peak_bytes, std::uint64_t{10} << 20);
  const Ends bound = run_text(frame_of_many_samples, {}, {.memory = free.result.peak_bytes / 2});
  EXPECT_EQ(bound.result.end, RunResult::End::failed);
  const Diagnostic d = only_error(bound.result.problems);
  EXPECT_EQ(d.code, "memory");
  EXPECT_EQ(d.pointer, "/nodes/pixels") << d.message;
}

// Nodes side by side find the memory full one after the other: that is one problem.
TEST(NodeErrors, MemoryThatIsFullIsOneProblem) {
  std::string nodes;
  for (int i = 0; i < 40; ++i)
    nodes += (i == 0 ? "" : ",\n") + ("\"p" + std::to_string(i)) +
             R"(": { "type": "supersample.pattern", "params": { "samples": 1024 } })";
  for (int round = 0; round < 10; ++round) {
    const Ends ends = run_text(nodes, {}, {.memory = 1000});
    EXPECT_EQ(ends.result.end, RunResult::End::failed);
    EXPECT_EQ(only_error(ends.result.problems).code, "memory");
  }
}

}  // namespace
}  // namespace frustum
