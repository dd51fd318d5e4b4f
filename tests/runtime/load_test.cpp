#include "runtime/graph/load.h"

#include "runtime/buffers/value.h"
#include "tests/support/stand_in_nodes.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <random>

namespace frustum {
namespace {

using test::TempFolder;

Loaded load(const std::string& text, const LoadOptions& options = {}) {
  return load_graph_text(text, "t.json", test::stand_in_nodes(), options);
}

std::string graph_with(const std::string& nodes, const std::string& more = "") {
  return "{ \"format\": \"frustum.graph/1\", " + more + " \"nodes\": { " + nodes + " } }";
}

// "code pointer" of every error, in order.
std::vector<std::string> errors(const Loaded& l) {
  std::vector<std::string> out;
  for (const Diagnostic& d : l.problems.list())
    if (d.severity == Severity::error) out.push_back(d.code + " " + d.pointer);
  return out;
}
using Lines = std::vector<std::string>;

Diagnostic first_error(const Loaded& l) {
  for (const Diagnostic& d : l.problems.list())
    if (d.severity == Severity::error) return d;
  return {};
}

std::vector<std::string> ids(const Graph& g) {
  std::vector<std::string> out;
  for (const GraphNode& n : g.nodes) out.push_back(n.id);
  return out;
}

template <class T>
T param(const Graph& g, std::string_view id, std::string_view name) {
  for (const GraphNode& n : g.nodes)
    if (n.id == id)
      for (const ParamField& f : n.type->params.fields)
        if (f.name == name) return write_record(n.type->params, n.params.get())[std::string(name)].get<T>();
  throw std::runtime_error("no such parameter");
}

const std::string front =
    R"("teapot": { "type": "io.load_patches" },
       "camera": { "type": "scene.camera" },
       "mesh": { "type": "surface.tessellate", "in": { "surface": "teapot", "camera": "camera" } },
       "eye": { "type": "project.view", "in": { "mesh": "mesh", "camera": "camera" } },
       "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } })";

TEST(LoadGraph, FeedersComeFirstAndTheOrderOfTheFileIsKept) {
  const Loaded l = load(graph_with(
      R"("eye": { "type": "project.view", "in": { "mesh": "mesh", "camera": "camera" } },
         "mesh": { "type": "surface.tessellate", "in": { "surface": "teapot" } },
         "spare": { "type": "scene.camera" },
         "camera": { "type": "scene.camera" },
         "teapot": { "type": "io.load_patches" })"));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(ids(*l.graph), (Lines{"spare", "camera", "teapot", "mesh", "eye"}));
}

TEST(LoadGraph, ABareNodeMeansItsFirstOutput) {
  const Loaded l = load(graph_with(
      front +
          R"(, "screen": { "type": "project.viewport", "in": { "mesh": "clip.mesh", "camera": "camera" } },
     "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen" } })",
      R"("outputs": { "z": { "layers": { "": "hits", "Z": "hits.depth" }, "file": "z.exr" } }, )"));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  const auto& layers = l.graph->outputs.at(0).layers;
  EXPECT_EQ(l.graph->name(layers[0].from), "hits.visibility");
  EXPECT_EQ(l.graph->name(layers[1].from), "hits.depth");
  EXPECT_EQ(l.graph->find_port("hits.depth"), layers[1].from);
  EXPECT_EQ(l.graph->find_port("hits"), layers[0].from);
  EXPECT_FALSE(l.graph->find_port("hits.color"));
  EXPECT_FALSE(l.graph->find_port("z"));
  EXPECT_EQ(l.graph->find_output("z"), l.graph->outputs.data());
}

TEST(LoadGraph, GraphParametersFillNodesWhereverTheyStand) {
  const Loaded l = load(graph_with(
      R"("camera": { "type": "scene.camera", "params": { "resolution": "$size", "eye": [1, "$y", 3] } },
         "teapot": { "type": "io.load_patches", "params": { "file": "$$cash.json" } },
         "turn": { "type": "transform.affine", "in": { "geometry": "teapot" }, "params": { "steps": [{ "rotate": { "degrees": "$y" } }] } })",
      R"("params": { "size": [64, 32], "y": 2.5 },)"));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(param<Json>(*l.graph, "camera", "resolution"), Json::array({64, 32}));
  EXPECT_EQ(param<Json>(*l.graph, "camera", "eye"), Json::array({1.0, 2.5, 3.0}));
  EXPECT_EQ(param<std::string>(*l.graph, "teapot", "file"), "$cash.json");
  EXPECT_EQ(param<Json>(*l.graph, "turn", "steps")[0]["rotate"]["degrees"], 2.5);
}

TEST(LoadGraph, PrecisionAndSeedAreTheGraphsUnlessTheNodeSaysOtherwise) {
  const std::string text =
      graph_with(R"("a": { "type": "scene.camera" }, "b": { "type": "scene.camera", "precision": "single" })",
                 R"("precision": "double", "seed": 7,)");
  const Loaded l = load(text);
  ASSERT_TRUE(l.graph);
  EXPECT_EQ(l.graph->seed, 7u);
  EXPECT_EQ(l.graph->nodes[0].precision, Precision::real_double);
  EXPECT_EQ(l.graph->nodes[1].precision, Precision::single);
  const Loaded forced = load(text, {.precision = Precision::single});
  EXPECT_EQ(forced.graph->nodes[0].precision, Precision::single);
}

TEST(LoadGraph, LiteralsFeedKindsOfValues) {
  const std::string identity = "[[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]";
  const std::string nodes =
      R"("teapot": { "type": "io.load_patches" },
         "turn": { "type": "transform.affine", "in": { "geometry": "teapot", "matrix": { "value": )";
  const Loaded l = load(graph_with(nodes + identity + " } } }"));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  const Source& source = l.graph->nodes[1].inputs[1].at(0);
  EXPECT_EQ(std::get<Buffer>(source).as<Matrix>()->value, glm::dmat4(1));
  EXPECT_EQ(errors(load(graph_with(nodes + "[1] } } }"))), Lines{"wrong_type /nodes/turn/in/matrix/value"});
}

TEST(LoadGraph, AnOutputOfSeveralKindsFollowsItsInput) {
  const std::string chain = R"("teapot": { "type": "io.load_patches" },
     "turn": { "type": "transform.affine", "in": { "geometry": "teapot" } },
     "again": { "type": "transform.affine", "in": { "geometry": "turn" } }, )";
  EXPECT_TRUE(
      load(graph_with(chain + R"("mesh": { "type": "surface.tessellate", "in": { "surface": "again" } })"))
          .graph);
  const Loaded l =
      load(graph_with(chain + R"("cut": { "type": "cull.backface", "in": { "mesh": "again" } })"));
  EXPECT_EQ(errors(l), Lines{"wrong_type /nodes/cut/in/mesh"});
  EXPECT_EQ(first_error(l).message, "again.geometry (surface) cannot feed cut.mesh (mesh)");
}

TEST(LoadGraph, SpacesFlowThroughNodesThatKeepThem) {
  const std::string cull = front + R"(, "a": { "type": "cull.backface", "in": { "mesh": "clip" } },
     "b": { "type": "cull.backface", "in": { "mesh": "a" } }, )";
  EXPECT_TRUE(
      load(graph_with(cull + R"("cut": { "type": "clip.homogeneous", "in": { "mesh": "b" } })")).graph);
  const Loaded l = load(
      graph_with(cull + R"("eye2": { "type": "project.view", "in": { "mesh": "b", "camera": "camera" } })"));
  ASSERT_EQ(errors(l), Lines{"wrong_space /nodes/eye2/in/mesh"});
  EXPECT_EQ(first_error(l).message, "b.mesh is in clip space, but eye2.mesh takes object or world space");
}

// ----- settings

TEST(LoadGraph, SettingsReachGraphAndNodeParameters) {
  const std::string text =
      graph_with(R"("camera": { "type": "scene.camera", "params": { "resolution": "$size", "fov_y": 20 } })",
                 R"("params": { "size": [64, 32] },)");
  const Loaded l =
      load(text, {.settings = {{"size", "[1, 2]"}, {"camera:fov_y", "50"}, {"camera:fov_y", "60"}}});
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(param<Json>(*l.graph, "camera", "resolution"), Json::array({1, 2}));
  EXPECT_EQ(param<double>(*l.graph, "camera", "fov_y"), 60);
}

TEST(LoadGraph, TextThatIsNoJsonStandsForItself) {
  const std::string text = graph_with(R"("teapot": { "type": "io.load_patches" })");
  EXPECT_EQ(
      param<std::string>(*load(text, {.settings = {{"teapot:file", "a b.json"}}}).graph, "teapot", "file"),
      "a b.json");
  EXPECT_EQ(
      param<std::string>(*load(text, {.settings = {{"teapot:file", "\"$x\""}}}).graph, "teapot", "file"),
      "$x");
}

TEST(LoadGraph, WrongSettingsAreDiagnosedWithTheirAddress) {
  const std::string text =
      graph_with(R"("camera": { "type": "scene.camera", "params": { "resolution": "$size" } })",
                 R"("params": { "size": [64, 32] },)");
  const auto only = [&](const Setting& setting) {
    const Loaded l = load(text, {.settings = {setting}});
    EXPECT_EQ(errors(l).size(), 1u);
    return first_error(l);
  };
  Diagnostic d = only({"camera:fvo_y", "1"});
  EXPECT_EQ(d.code + d.pointer + " " + d.message,
            "unknown_address --set camera:fvo_y: there is no such parameter");
  EXPECT_EQ(d.suggestions, Lines{"camera:fov_y"});
  EXPECT_EQ(d.line, 1);
  d = only({"camera:fov_y", "270"});
  EXPECT_EQ(d.code + " " + d.pointer, "out_of_range /nodes/camera/params/fov_y");
  EXPECT_NE(d.message.find("(from --set camera:fov_y=270)"), std::string::npos);
  d = only({"size", "small"});
  EXPECT_EQ(d.code + " " + d.pointer, "wrong_type /nodes/camera/params/resolution");
  EXPECT_NE(d.message.find("(from --set size=small)"), std::string::npos);
  d = only({"size", std::string(100000, '[')});
  EXPECT_EQ(d.code + d.pointer, "too_deep");
  EXPECT_EQ(only({"size", "[1e999, 2]"}).code, "not_finite");
}

TEST(LoadGraph, TheFrameNumberSetsTheParameterOfThatName) {
  const std::string text =
      graph_with(R"("camera": { "type": "scene.camera", "params": { "fov_y": "$frame" } })",
                 R"("params": { "frame": 1 },)");
  EXPECT_EQ(param<double>(*load(text, {.frame = 12}).graph, "camera", "fov_y"), 12);
}

// ----- graphs used as nodes

const std::string inner =
    R"({ "format": "frustum.graph/1", "params": { "samples": 4, "fov": 30 },
         "inputs": { "mesh": { "type": "mesh" }, "camera": { "type": "camera" }, "lights": { "type": "light", "list": true },
                     "texture": { "type": "texture", "optional": true } },
         "nodes": {
           "screen": { "type": "project.viewport", "in": { "mesh": "$mesh", "camera": "$camera" } },
           "pattern": { "type": "supersample.pattern", "params": { "samples": "$samples" } },
           "hits": { "type": "rasterize.triangles", "in": { "mesh": "screen", "pattern": "pattern" } },
           "albedo": { "type": "texture.sample", "in": { "hits": "hits", "texture": "$texture" } },
           "lit": { "type": "shade.surface", "in": { "hits": "hits", "albedo": "albedo", "lights": ["$lights"] } } },
         "outputs": { "image": { "from": "lit" }, "albedo": { "from": "albedo" }, "depth": { "from": "hits.depth" } } })";

std::string user(const std::string& in, const std::string& more = "",
                 const std::string& outputs = R"("o": { "from": "draw", "file": "o.exr" })") {
  return graph_with(
      front +
          R"(, "checks": { "type": "texture.checker" }, "a": { "type": "light.directional" }, "b": { "type": "light.directional" },
    "draw": { "type": "graph", "file": "inner.json", "in": { "mesh": "clip", "camera": "camera", "lights": ["a", "b"])" +
          in + " }" + more + " }",
      "\"outputs\": { " + outputs + " },");
}

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
  EXPECT_EQ(message(".."), "'..' is a folder, not a graph file");
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

// ----- limits

TEST(LoadGraph, LongChainsDoNotExhaustTheStack) {
  std::string nodes = R"("n0": { "type": "cull.backface", "in": { "mesh": "n19999" } })";
  for (int i = 1; i < 20000; ++i)
    nodes += ",\n\"n" + std::to_string(i) + "\": { \"type\": \"cull.backface\", \"in\": { \"mesh\": \"n" +
             std::to_string(i - 1) + "\" } }";
  EXPECT_EQ(errors(load(graph_with(nodes))), Lines{"cycle /nodes/n0/in/mesh"});
}

// Suggestions for each would take minutes: ten thousand times ten thousand names.
TEST(LoadGraph, TenThousandUnknownNamesAreToldAtOnce) {
  std::string nodes;
  for (int i = 0; i < 10000; ++i)
    nodes += (i == 0 ? "\"" : ",\n\"") + ("node_number_" + std::to_string(i)) +
             R"(": { "type": "cull.backface", "in": { "mesh": "noed_numbre_)" + std::to_string(i) + "\" } }";
  const auto start = std::chrono::steady_clock::now();
  const Loaded l = load(graph_with(nodes));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  ASSERT_EQ(errors(l).size(), 10000u);
  EXPECT_EQ(first_error(l).suggestions.front(), "node_number_0");
  EXPECT_TRUE(l.problems.list().back().suggestions.empty());
}

TEST(LoadGraph, FramesOfAGraphThatHasNoneAreAWarning) {
  const auto codes = [](const std::string& params) {
    LoadOptions options;
    options.frame = 3;
    Lines out;
    const Loaded loaded =
        load(graph_with(front, params + R"("outputs": { "o": { "from": "clip" } }, )"), options);
    for (const Diagnostic& d : loaded.problems.list())
      if (d.code == "no_frame_parameter") out.push_back(d.code);
    return out;
  };
  EXPECT_EQ(codes(""), Lines{"no_frame_parameter"});
  EXPECT_EQ(codes(R"("params": { "frame": 1 }, )"), Lines{});
}

// Text that was right once, changed at random: whatever it has become is told, with a code and a place, and nothing else
// happens.
TEST(LoadGraph, MutatedGraphsAreReadOrDiagnosed) {
  const std::vector<std::string> seeds = {
      graph_with(front, R"("params": { "size": [64, 32] }, "outputs": { "o": { "from": "clip" } }, )"), inner,
      user("")};
  const std::vector<std::string> pieces = {
      "\"",     "{",        "}",         "[",        "]",       ",",    ":",
      "$",      "$size",    "null",      "1e999",    "NaN",     "-1",   "0.5",
      "\"in\"", "\"type\"", "\"graph\"", "\"mesh\"", "\"a.b\"", "\"\"", "{ \"value\": 3 }",
      "[]",     "{}",       "true",      "\xC3",     "\n",      "../",  "draw/lit"};
  std::mt19937 random(7);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random()) % n; };
  int good = 0;
  for (int i = 0; i < 6000; ++i) {
    std::string text = seeds[below(seeds.size())];
    for (std::size_t n = 1 + below(4); n > 0; --n) {
      const std::size_t at = below(text.size() + 1), length = std::min(below(12), text.size() - at);
      switch (below(4)) {
        case 0: text.erase(at, length); break;
        case 1: text.insert(at, pieces[below(pieces.size())]); break;
        case 2: text.replace(at, length, pieces[below(pieces.size())]); break;
        default: text.insert(at, text.substr(below(text.size() + 1), below(40))); break;
      }
    }
    const Loaded l = load(text, {.settings = {{"camera:fov_y", "20"}}});
    ASSERT_EQ(l.graph.has_value(), !l.problems.has_errors()) << text;
    good += l.graph.has_value();
    for (const Diagnostic& d : l.problems.list()) {
      ASSERT_FALSE(d.code.empty() || d.message.empty()) << text;
      ASSERT_TRUE(d.line > 0 && d.column > 0) << text << "\n" << to_text(l.problems);
    }
    to_json(l.problems).dump();  // throws for text that is not UTF-8
  }
  EXPECT_GT(good, 10);
}

TEST(LoadGraph, AFileThatCannotBeReadIsTheWorldsFault) {
  EXPECT_THROW(load_graph("no/such/file.json", test::stand_in_nodes()), WorldError);
  EXPECT_THROW(load_graph("/", test::stand_in_nodes()), WorldError);
}

}  // namespace
}  // namespace frustum
