// Graphs used as nodes: flattened, found, told apart, and refused where they have no end.
#include "tests/support/load_graphs.h"
#include "tests/support/stand_in_nodes.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace frustum {
namespace {

using namespace test;

class GraphsAsNodes : public testing::Test {
 protected:
  Loaded load(const std::string& text, const LoadOptions& options = {}) const {
    return load_graph(folder_.write("main.json", text), test::stand_in_nodes(), options);
  }
  TempFolder folder_;
  std::string inner_ = folder_.write("inner.json", inner);
};

TEST_F(GraphsAsNodes, AreFlattenedAndKeepTheirPlace) {
  const Loaded l = load(user(R"(, "texture": "checks")"));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  const Graph& g = *l.graph;
  const auto lit = g.find_port("draw/lit");
  ASSERT_TRUE(lit);
  const GraphNode& node = g.nodes[lit->node];
  EXPECT_EQ(node.inputs[2].size(), 2u);  // both lights of the list
  EXPECT_EQ(node.place.pointer, "/nodes/lit");
  EXPECT_EQ(node.place.file, inner_);
  EXPECT_EQ(node.place.line, 9);
  EXPECT_EQ(g.outputs.at(0).layers.at(0).from, *lit);
  EXPECT_EQ(g.find_port("draw"), lit);
  EXPECT_EQ(g.find_port("draw.depth"), g.find_port("draw/hits.depth"));
}

TEST_F(GraphsAsNodes, AnOptionalInputLeftOutTakesWhatNeedsItAlong) {
  const Loaded l = load(user(""));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_FALSE(l.graph->find_port("draw/albedo"));
  EXPECT_FALSE(l.graph->find_port("draw.albedo"));
  const auto lit = l.graph->find_port("draw/lit");
  ASSERT_TRUE(lit);
  EXPECT_TRUE(l.graph->nodes[lit->node].inputs[1].empty());
}

TEST_F(GraphsAsNodes, WhatIsLeftOutCannotBeReadOutside) {
  EXPECT_EQ(errors(load(user("", "", R"("o": { "from": "draw.albedo", "file": "o.exr" })"))),
            Lines{"left_out /outputs/o/from"});
  const Loaded l =
      load(user("", R"(}, "stats": { "type": "check.statistics", "in": { "image": "draw.albedo" })"));
  EXPECT_EQ(errors(l), Lines{"left_out /nodes/stats/in/image"});
}

TEST_F(GraphsAsNodes, TakeParametersOverridesAndSettings) {
  const std::string text =
      user("", R"(, "params": { "samples": 9 }, "overrides": { "lit:interpolation": "flat" })");
  const Loaded l = load(text);
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(param<int>(*l.graph, "draw/pattern", "samples"), 9);
  EXPECT_EQ(param<std::string>(*l.graph, "draw/lit", "interpolation"), "flat");
  const Loaded set =
      load(text, {.settings = {{"draw:samples", "16"}, {"draw/lit:interpolation", "gouraud"}}});
  ASSERT_TRUE(set.graph) << to_text(set.problems);
  EXPECT_EQ(param<int>(*set.graph, "draw/pattern", "samples"), 16);
  EXPECT_EQ(param<std::string>(*set.graph, "draw/lit", "interpolation"), "gouraud");
}

TEST_F(GraphsAsNodes, NestToAnyDepthAndTheOutermostWins) {
  folder_.write("middle.json", R"({ "format": "frustum.graph/1", "params": { "n": 2 },
    "inputs": { "m": { "type": "mesh" }, "c": { "type": "camera" }, "l": { "type": "light", "list": true }, "t": { "type": "texture", "optional": true } },
    "nodes": { "raster": { "type": "graph", "file": "inner.json", "in": { "mesh": "$m", "camera": "$c", "lights": "$l", "texture": "$t" },
                           "params": { "samples": "$n" }, "overrides": { "lit:interpolation": "flat" } } },
    "outputs": { "out": { "from": "raster.image" } } })");
  const std::string nodes =
      front +
      R"(, "draw": { "type": "graph", "file": "middle.json", "in": { "m": "clip", "c": "camera", "l": [] },
    "params": { "n": "$samples" }, "overrides": { "raster/lit:interpolation": "$how" } })";
  const std::string text = graph_with(
      nodes,
      R"("params": { "samples": 3, "how": "gouraud" }, "outputs": { "o": { "from": "draw.out", "file": "o.png" } },)");
  const Loaded l = load(text);
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(param<int>(*l.graph, "draw/raster/pattern", "samples"), 3);
  EXPECT_EQ(param<std::string>(*l.graph, "draw/raster/lit", "interpolation"), "gouraud");
  EXPECT_FALSE(l.graph->find_port("draw/raster/albedo"));
  const Loaded set =
      load(text, {.settings = {{"draw/raster/lit:interpolation", "phong"}, {"draw/raster:samples", "5"}}});
  EXPECT_EQ(param<std::string>(*set.graph, "draw/raster/lit", "interpolation"), "phong");
  EXPECT_EQ(param<int>(*set.graph, "draw/raster/pattern", "samples"), 5);
}

TEST_F(GraphsAsNodes, ProblemsInsideNameTheFileAndTheUse) {
  const Loaded l = load(user("", R"(, "params": { "samples": 0 })"));
  ASSERT_EQ(errors(l), Lines{"out_of_range /nodes/pattern/params/samples"});
  const Diagnostic d = first_error(l);
  EXPECT_EQ(d.file, inner_);
  ASSERT_EQ(d.related.size(), 2u);
  EXPECT_EQ(d.related[0].pointer, "/nodes/draw/params/samples");
  EXPECT_EQ(d.related[1].pointer, "/nodes/draw");
  EXPECT_EQ(d.related[1].message, "used here as 'draw'");
}

TEST_F(GraphsAsNodes, AProblemOfAFileUsedTwiceStandsOnce) {
  folder_.write(
      "inner.json",
      R"({ "format": "frustum.graph/1", "nodes": { "c": { "type": "scene.camera", "params": { "fov_y": 200 } } },
    "outputs": { "camera": { "from": "c" } } })");
  const Loaded l = load(graph_with(
      R"("a": { "type": "graph", "file": "inner.json" }, "b": { "type": "graph", "file": "./inner.json" })"));
  EXPECT_EQ(errors(l), Lines{"out_of_range /nodes/c/params/fov_y"});
}

TEST_F(GraphsAsNodes, TheWrongKindIsNamedAtTheLinkThatEnters) {
  const Loaded l = load(user(R"(, "texture": "camera")"));
  ASSERT_EQ(errors(l), Lines{"wrong_type /nodes/draw/in/texture"});
  EXPECT_EQ(first_error(l).message, "camera.camera (camera) cannot feed draw.texture (texture)");
}

TEST_F(GraphsAsNodes, AreFoundInTheLibrary) {
  std::filesystem::create_directory(folder_.path() + "/lib");
  folder_.write("lib/raster.json", inner);
  std::string text = user("");
  text.replace(text.find("inner.json"), 10, "lib:raster");
  EXPECT_TRUE(load(text, {.library_folders = {folder_.path(), folder_.path() + "/lib"}}).graph);
  text.replace(text.find("lib:raster"), 10, "lib:rastre");
  const Loaded l = load(text, {.library_folders = {folder_.path() + "/lib"}});
  EXPECT_EQ(errors(l), Lines{"missing_file /nodes/draw/file"});
  EXPECT_EQ(first_error(l).suggestions, Lines{"lib:raster"});
}

TEST_F(GraphsAsNodes, AFileCannotContainItself) {
  folder_.write("a.json", graph_with(R"("x": { "type": "graph", "file": "b.json" })"));
  const std::string b =
      folder_.write("b.json", graph_with(R"("y": { "type": "graph", "file": "./a.json" })"));
  const Loaded l = load_graph(folder_.file("a.json"), test::stand_in_nodes());
  ASSERT_EQ(errors(l), Lines{"file_cycle /nodes/y/file"});
  EXPECT_EQ(first_error(l).message, "a graph cannot contain itself: a.json -> b.json -> a.json");
}

TEST_F(GraphsAsNodes, ThatOnlyPassDataRoundAreACycle) {
  folder_.write(
      "pass.json",
      R"({ "format": "frustum.graph/1", "inputs": { "i": { "type": "mesh" } }, "nodes": {}, "outputs": { "o": { "from": "$i" } } })");
  const Loaded l = load(graph_with(
      R"("a": { "type": "graph", "file": "pass.json", "in": { "i": "b" } }, "b": { "type": "graph", "file": "pass.json", "in": { "i": "a" } },
    "cut": { "type": "cull.backface", "in": { "mesh": "a" } })"));
  EXPECT_EQ(errors(l), Lines{"cycle /nodes/cut/in/mesh"});
}

TEST_F(GraphsAsNodes, ThatMultiplyWithoutEndAreRefused) {
  for (int i = 0; i < 40; ++i) {
    const std::string next = "\"type\": \"graph\", \"file\": \"g" + std::to_string(i + 1) + ".json\"";
    folder_.write("g" + std::to_string(i) + ".json",
                  graph_with("\"a\": { " + next + " }, \"b\": { " + next + " }"));
  }
  folder_.write("g40.json", graph_with(R"("c": { "type": "scene.camera" })"));
  EXPECT_EQ(errors(load_graph(folder_.file("g0.json"), test::stand_in_nodes())), Lines{"too_large /nodes/a"});
}

// Also where the files below were read before, for a shorter way to them.
TEST_F(GraphsAsNodes, ThatStandInsideEachOtherTooDeeplyAreRefused) {
  const auto name = [](int i) { return "d" + std::to_string(i) + ".json"; };
  const auto use = [&](const std::string& id, int i) {
    return "\"" + id + R"(": { "type": "graph", "file": ")" + name(i) + "\" }";
  };
  const int files = 3000;
  for (int i = 1; i < files; ++i) folder_.write(name(i), graph_with(use("next", i + 1)));
  folder_.write(name(files), graph_with(R"("c": { "type": "scene.camera" })"));
  const Loaded chain = load_graph(folder_.file(name(1)), test::stand_in_nodes());
  ASSERT_EQ(errors(chain), Lines{"too_deep /nodes/next/file"});
  EXPECT_EQ(first_error(chain).file, folder_.file(name(256)));
  EXPECT_EQ(first_error(chain).got, name(257));
  EXPECT_EQ(errors(load_graph(folder_.file(name(files - 255)), test::stand_in_nodes())), Lines{});

  std::string uses;
  for (int i = files; i > files - 400; --i)
    uses += (uses.empty() ? "" : ", ") + use("u" + std::to_string(i), i);
  const Loaded known = load_graph(folder_.write("top.json", graph_with(uses)), test::stand_in_nodes());
  ASSERT_FALSE(errors(known).empty());
  EXPECT_EQ(first_error(known).code, "too_deep");
}

TEST_F(GraphsAsNodes, ThatPassALinkOnWithoutEndAreRefused) {
  folder_.write(
      "pass.json",
      R"({ "format": "frustum.graph/1", "inputs": { "i": { "type": "mesh" } }, "nodes": {}, "outputs": { "o": { "from": "$i" } } })");
  std::string nodes = R"("p0": { "type": "graph", "file": "pass.json", "in": { "i": "cut" } })";
  for (int i = 1; i < 40000; ++i)
    nodes += ",\n\"p" + std::to_string(i) + R"(": { "type": "graph", "file": "pass.json", "in": { "i": "p)" +
             std::to_string(i - 1) + "\" } }";
  nodes += R"(, "cut": { "type": "cull.backface", "in": { "mesh": "p39999" } })";
  EXPECT_EQ(errors(load(graph_with(nodes))), Lines{"too_deep /nodes/cut/in/mesh"});
}

TEST_F(GraphsAsNodes, AreNoFoldersAndLibraryNamesNoPaths) {
  const auto message = [&](const std::string& file) {
    return first_error(load(graph_with(R"("a": { "type": "graph", "file": ")" + file + "\" }"))).message;
  };
  EXPECT_EQ(message(".."), "'..' is a folder, not a file");
  EXPECT_EQ(message("lib:../inner"),
            "'lib:../inner' is not the name of a library graph: it has neither slashes nor dots");
}

TEST_F(GraphsAsNodes, CanBeCheckedAlone) {
  const Loaded l = load_graph(inner_, test::stand_in_nodes());
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(ids(*l.graph), Lines{"pattern"});
  for (const Diagnostic& d : l.problems.list())
    EXPECT_TRUE(d.code == "open_input" || d.code == "unused_parameter") << d.code;
}

}  // namespace
}  // namespace frustum
