#include "runtime/graph/load.h"

#include "runtime/buffers/value.h"
#include "tests/support/load_graphs.h"
#include "tests/support/stand_in_nodes.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <random>

namespace frustum {
namespace {

using namespace test;

Loaded load(const std::string& text, const LoadOptions& options = {}) {
  return load_graph_text(text, "t.json", test::stand_in_nodes(), options);
}

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

TEST(LoadGraph, ADollarIsWrittenTwiceInDefaultsToo) {
  const Loaded l = load(graph_with(
      R"("teapot": { "type": "io.load_patches", "params": { "file": "$cash" } },
         "copy": { "type": "io.load_patches", "params": { "file": "$$cash.json" } })",
      R"("params": { "cash": "$$cash.json" },)"));
  ASSERT_TRUE(l.graph) << to_text(l.problems);
  EXPECT_EQ(param<std::string>(*l.graph, "teapot", "file"), "$cash.json");
  EXPECT_EQ(param<std::string>(*l.graph, "copy", "file"), "$cash.json");
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
