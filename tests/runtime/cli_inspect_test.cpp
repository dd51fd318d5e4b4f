// frustum inspect, diff and plan as a user reads them: tables, marks, and options that have no effect.
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace frustum {
namespace {

using nlohmann::json;
using test::frustum;
using test::ProcessResult;
using test::TempFolder;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string stages = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/gallery/teapot_stages.json";

ProcessResult inspect(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"inspect", stages});
  arguments.insert(arguments.end(), {"--set", "resolution=[64, 36]", "--set", "samples=2"});
  return frustum(arguments);
}

// ----- what is wrong with looking

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

TEST(CliInspect, AMistakeIsOneErrorWithItsPlaceAndWhatWasMeant) {
  const TempFolder folder;
  const struct {
    std::vector<std::string> arguments;
    const char *code, *pointer;
    std::string file, expected, suggestion;
  } cases[] = {
      {{"display", "--pixel", "64,0"},
       "outside_window",
       "/nodes/display",
       stages,
       "x from 0 to 63, y from 0 to 35",
       ""},
      {{"display", "--provenance", "64,0"},
       "outside_window",
       "/nodes/display",
       stages,
       "a pixel of the picture",
       ""},
      {{"camera", "--pixel", "1,1"}, "not_pixels", "/nodes/camera", stages, "a port of pixels", ""},
      {{"mesh", "--provenance", "1,1"}, "not_pixels", "/nodes/mesh", stages, "a port of pixels", ""},
      {{"camera", "--table"}, "no_table", "/nodes/camera", stages, "a port whose buffer has rows", ""},
      {{"camera", "--save", folder.file("x.csv")},
       "unknown_format",
       "",
       folder.file("x.csv"),
       "one of: json",
       ""},
      {{"mesh", "--save", folder.file("x.png")},
       "unknown_format",
       "",
       folder.file("x.png"),
       "one of: ply, obj, glb, gltf, csv, json",
       ""},
      {{"camera", "--save", folder.file("x.jsno")},
       "unknown_format",
       "",
       folder.file("x.jsno"),
       "one of: json",
       folder.file("x.json")},
      {{"display", "--save", folder.file("x.pgn")},
       "unknown_format",
       "",
       folder.file("x.pgn"),
       "one of: exr, png, tif, tiff, jpg, jpeg, hdr, csv, json",
       folder.file("x.png")},
      {{"points", "--save", folder.file("x.png")}, "format_cannot_hold", "", folder.file("x.png"), "", ""},
      {{"display", "--save", folder.file("x.png"), "--sample", "1"},
       "out_of_range",
       "",
       folder.file("x.png"),
       "",
       ""},
  };
  for (const auto& c : cases) {
    const auto shown = testing::PrintToString(c.arguments);
    const auto text = inspect(c.arguments);
    EXPECT_EQ(text.code, 2) << shown;
    EXPECT_THAT(text.out, IsEmpty()) << shown;
    EXPECT_EQ(times(text.err, "error["), 1u) << text.err;
    auto arguments = c.arguments;
    arguments.push_back("--json");
    const json all = json::parse(inspect(arguments).out)["diagnostics"];
    ASSERT_EQ(all.size(), 1u) << all;
    EXPECT_EQ(all[0]["code"], c.code) << shown;
    EXPECT_EQ(all[0]["file"], c.file) << shown;
    EXPECT_EQ(all[0]["pointer"], c.pointer) << shown;
    EXPECT_EQ(all[0]["line"] > 0, *c.pointer != 0) << shown;
    EXPECT_EQ(all[0]["expected"], c.expected) << shown;
    EXPECT_EQ(all[0]["suggestions"].empty() ? "" : all[0]["suggestions"][0], c.suggestion) << shown;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "and nothing is written";
}

TEST(CliInspect, NamesTheNearestPortOfTheKindThatIsMeant) {
  const TempFolder folder;
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "shade": { "type": "shade.material" }, "shape": { "type": "mesh.box" } } })");
  EXPECT_THAT(frustum({"inspect", graph, "shade", "--table"}).err, HasSubstr("did you mean 'shape.mesh'?"));
  EXPECT_THAT(inspect({"lit", "--provenance", "70,1"}).err, Not(HasSubstr("did you mean")));
}

TEST(CliInspect, NamesThePortsOfANodeThatHasNoSuchOne) {
  const auto r = inspect({"hits.picture"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, AllOf(HasSubstr("error[unknown_address] " + stages), HasSubstr(" /nodes/hits\n"),
                           HasSubstr("'hits' (rasterize.triangles) has no output 'picture'"),
                           HasSubstr("'hits.visibility'")));
}

TEST(CliInspect, AFormatThatIsNoneIsKnownBeforeAnythingRuns) {
  const TempFolder folder;
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "broken.obj" } } } })");
  folder.write("broken.obj", "v 0 zero 0");
  const auto r = frustum({"inspect", graph, "m", "--save", folder.file("x.plz")});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, AllOf(HasSubstr("unknown_format"), Not(HasSubstr("malformed_file"))));
}

TEST(CliInspect, ASampleIsOneThatThePixelHas) {
  const TempFolder folder;
  EXPECT_EQ(inspect({"lit", "--save", folder.file("x.exr"), "--sample", "1"}).code, 0);
  EXPECT_EQ(inspect({"lit", "--save", folder.file("y.exr"), "--sample", "2"}).code, 2);
  const auto whole = inspect({"lit", "--save", folder.file("y.csv"), "--sample", "1"});
  EXPECT_EQ(whole.code, 2);
  EXPECT_THAT(whole.err, HasSubstr("gets the whole buffer"));
  EXPECT_FALSE(std::filesystem::exists(folder.file("y.exr")));
  EXPECT_FALSE(std::filesystem::exists(folder.file("y.csv")));
}

// ----- what is shown

TEST(CliInspect, ShowsAComponentOfAMeshInALine) {
  const auto mesh = inspect({"mesh"});
  ASSERT_EQ(mesh.code, 0) << mesh.err;
  EXPECT_THAT(mesh.out, Not(ContainsRegex("[{}\"]"))) << "no JSON in what people read";
  EXPECT_THAT(mesh.out, AllOf(HasSubstr("values: 64403, all finite\n"), HasSubstr("vertices: 1619\n")));
  EXPECT_THAT(mesh.out,
              ContainsRegex("\n +name +domain +kind +rows +space +count +min +max +mean +p5 +p50 +p95 "
                            "+histogram\n"));
  EXPECT_THAT(mesh.out, ContainsRegex("\n +position.x +vertex +f32 +1619 +world +1619 +-3 +3.434000"));
  EXPECT_THAT(mesh.out, ContainsRegex("\n +triangle.z +face +u32 +3134 +none +3134 +0 +1618"));
  EXPECT_THAT(mesh.out, ContainsRegex("\n +patch +face +u32")) << "one component has no suffix";
  EXPECT_TRUE(json::parse(inspect({"mesh", "--json"}).out)["summary"]["columns"][0].contains("digest"));
}

TEST(CliInspect, LeavesNoJsonInTheTextOfAnyKindOfBuffer) {
  for (const char* port :
       {"teapot", "camera", "key", "clay", "world.matrix", "pattern", "checks", "hits", "display"}) {
    const auto r = inspect({port});
    ASSERT_EQ(r.code, 0) << port << r.err;
    EXPECT_THAT(r.out, Not(ContainsRegex("[{}\"]|\\[|\\]"))) << port;
  }
  const TempFolder folder;
  const auto points = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "p": { "type": "vector.make", "params": { "points": [[1, 2, 3], [4, 5, 6]] } } } })");
  const auto r = frustum({"inspect", points, "p"});
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, AllOf(ContainsRegex("\nx +2 +1 +4 "), ContainsRegex("\nz +2 +3 +6 ")));
}

TEST(CliInspect, MarksWhatIsNotFinite) {
  const TempFolder folder;
  folder.write(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 1\n1 0 0 nan\n0 1 0 inf\n0 0 1 2\n3 0 1 2\n");
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "a.ply" } } } })");
  const auto text = frustum({"inspect", graph, "m"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr(", of which 1 NaN, 1 +inf; the first: "), HasSubstr("not finite"),
                              ContainsRegex("\n +heat +vertex .* 1 NaN, 1 \\+inf")));
  const auto table = frustum({"inspect", graph, "m", "--table"});
  EXPECT_THAT(table.out, AllOf(ContainsRegex("\n1 ! "), ContainsRegex("\n2 ! "), ContainsRegex("\n0   "),
                               HasSubstr("those with ! are not finite")));
}

// What has no effect is refused: it would be taken for what was asked for.
TEST(CliInspect, RefusesOptionsThatWouldHaveNoEffect) {
  const TempFolder folder;
  const std::string file = folder.file("a.exr");
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{"lit", "--pixel", "3,4", "--provenance", "3,4"},
                                             {"lit", "--pixel", "3,4", "--table"},
                                             {"lit", "--provenance", "3,4", "--table"},
                                             {"lit", "--provenance", "3,4", "--save", file},
                                             {"lit", "--provenance", "3,4", "--region", "0,0,8,8"},
                                             {"lit", "--rows", "3"},
                                             {"lit", "--first", "3"},
                                             {"lit", "--sample", "1"},
                                             {"mesh", "--region", "0,0,8,8"}}) {
    const auto r = inspect(bad);
    EXPECT_EQ(r.code, 2) << testing::PrintToString(bad);
    EXPECT_THAT(r.out, IsEmpty());
    EXPECT_THAT(r.err, AllOf(HasSubstr(bad[1]), HasSubstr("frustum inspect --help")));
    auto with_json = bad;
    with_json.emplace_back("--json");
    EXPECT_EQ(json::parse(inspect(with_json).out)["diagnostics"][0]["code"], "usage");
  }
  EXPECT_EQ(inspect({"lit", "--table", "--first", "3", "--rows", "2"}).code, 0);
}

TEST(CliInspect, ARegionOutsideOfThePictureIsAnError) {
  for (const char* port : {"display", "hits.depth"}) {
    const auto r = inspect({port, "--region", "100,0,8,8"});
    EXPECT_EQ(r.code, 2) << r.out;
    EXPECT_THAT(r.err,
                AllOf(HasSubstr("error[empty_region]"), HasSubstr("no pixels in the region 100,0,8,8")));
  }
  EXPECT_EQ(inspect({"display", "--region", "60,30,8,8"}).code, 0) << "part of it lies inside";
  const auto run = frustum({"run", stages, "--set", "resolution=[64, 36]", "--set", "samples=1", "--want",
                            "display", "--region", "0,99,8,8", "--json"});
  EXPECT_EQ(run.code, 2);
  EXPECT_EQ(json::parse(run.out)["diagnostics"][0]["code"], "empty_region");
}

TEST(CliInspect, SaysWhatASavedPictureLacks) {
  const TempFolder folder;
  const auto sampled = inspect({"lit", "--save", folder.file("lit.exr")});
  EXPECT_EQ(sampled.code, 0);
  EXPECT_THAT(sampled.err, AllOf(HasSubstr("warning[sampled_output]"), HasSubstr("first of 2 samples")));
  EXPECT_THAT(inspect({"lit", "--save", folder.file("lit.exr"), "--sample", "1"}).err, IsEmpty())
      << "the sample was chosen";
  const auto linear = inspect({"pixels", "--save", folder.file("pixels.png"), "--json"});
  EXPECT_EQ(linear.code, 0);
  EXPECT_EQ(json::parse(linear.out)["diagnostics"][0]["code"], "display_format_linear");
  EXPECT_THAT(inspect({"pixels", "--save", folder.file("pixels.exr")}).err, IsEmpty());
  EXPECT_THAT(inspect({"display", "--save", folder.file("display.png")}).err, IsEmpty());
}

// ----- diff

TEST(CliDiff, ComparesColumnsByName) {
  const TempFolder folder;
  const auto a = folder.write("a.csv", "x,height,name\n1,2,one\n3,4,two\n"),
             b = folder.write("b.csv", "name,x,height\none,1,2\ntwo,3,4\n"),
             c = folder.write("c.csv", "name,x,hieght\none,1,2\ntwo,3,4\n"),
             more = folder.write("d.csv", "name,x,height,z\none,1,2,0\ntwo,3,4,0\n");
  const auto same = frustum({"diff", a, b});
  EXPECT_EQ(same.code, 0) << same.out;
  const auto typo = frustum({"diff", a, c});
  EXPECT_EQ(typo.code, 1);
  EXPECT_THAT(typo.out,
              HasSubstr("only the first has the columns height; the other has 'hieght', near to 'height'"));
  EXPECT_THAT(frustum({"diff", a, more}).out, HasSubstr("only the second has the columns z\n"));
  const auto other = folder.write("e.csv", "name,x,height\none,1,2\ntwo,3,5\n");
  EXPECT_THAT(frustum({"diff", a, other}).out, HasSubstr("worst: height of row 1: 4 and 5"));
}

TEST(CliDiff, ATableIsComparedWithATable) {
  const TempFolder folder;
  const auto csv = folder.write("a.csv", "x\n1\n");
  ASSERT_EQ(inspect({"mesh", "--save", folder.file("mesh.ply")}).code, 0);
  for (const bool first : {true, false}) {
    const std::string mesh = folder.file("mesh.ply");
    const auto r = frustum({"diff", first ? csv : mesh, first ? mesh : csv});
    EXPECT_EQ(r.code, 2);
    EXPECT_THAT(r.err, AllOf(HasSubstr("error[not_comparable]"), HasSubstr("a.csv is a table and ")));
  }
}

TEST(CliDiff, NothingIsNotTheSameAsNothing) {
  const TempFolder folder;
  const auto r = frustum({"diff", folder.write("a.csv", ""), folder.write("b.csv", "")});
  EXPECT_EQ(r.code, 2) << r.out;
  EXPECT_THAT(r.err, AllOf(HasSubstr("error[not_comparable]"), HasSubstr("hold no values")));
}

// ----- plan

// The plan makes the geometry, so the frame of every pass is known: what it says is near to what a run has.
TEST(CliPlan, EstimatesThePeakOfMemory) {
  for (const char* want : {"beauty", "display", "mesh"}) {
    const std::vector<std::string> how{
        stages, "--set", "resolution=[640, 360]", "--set", "samples=4", "--want", want, "--threads",
        "2",    "--json"};
    const auto of = [&](const char* command) {
      auto arguments = how;
      arguments.insert(arguments.begin(), command);
      if (std::string(command) == "run") arguments.insert(arguments.end(), {"--out", TempFolder().path()});
      const auto r = frustum(arguments);
      EXPECT_EQ(r.code, 0) << r.err;
      return json::parse(r.out);
    };
    const json plan = of("plan")["memory"];
    const auto used = of("run")["peak_bytes"].get<double>();
    const auto least = plan["peak_bytes"][0].get<double>(), most = plan["peak_bytes"][1].get<double>();
    EXPECT_GT(most, used * 0.9) << want;
    EXPECT_LT(least, used * 1.3) << want << ": tiles are as large as estimated, or smaller";
    EXPECT_LT(most, used * 4) << want;
    EXPECT_EQ(plan["at"].back(), std::string(want) == "mesh" ? "mesh" : "display");
    EXPECT_TRUE(plan["not_counted"].empty());
  }
  EXPECT_THAT(
      frustum({"plan", stages}).out,
      ContainsRegex("memory: [0-9.]+ MiB to [0-9.]+ MiB of buffers at the peak, in the pass to display\n"));
}

// Nodes that read a whole picture are prepared from its frame, whose pixels no plan fills.
TEST(CliPlan, NamesTheNodeThatAnEffectIsUndecidedFor) {
  const std::string& graph = stages;
  const auto whole = frustum({"plan", graph});
  ASSERT_EQ(whole.code, 0) << whole.err;
  EXPECT_THAT(whole.out, Not(HasSubstr("could not be made")));
  const auto none = frustum({"plan", graph, "--memory", "1K"});
  EXPECT_EQ(none.code, 2);
  EXPECT_THAT(none.err, HasSubstr("error[memory]"));
  EXPECT_THAT(none.out,
              AllOf(HasSubstr("' could not be made"), Not(HasSubstr("do not exist before the run"))));
  const auto object = json::parse(frustum({"plan", graph, "--memory", "1K", "--json"}).out);
  std::string node = object["diagnostics"][0]["pointer"];
  node = node.substr(std::string("/nodes/").size());
  int undecided = 0;
  for (const json& e : object["effects"])
    if (e["verdict"] == "undecided") {
      EXPECT_EQ(e["why"], "'" + node + "' could not be made");
      ++undecided;
    }
  EXPECT_GT(undecided, 0);
  EXPECT_EQ(frustum({"plan", graph, "--memory", "100G"}).out, whole.out);
  EXPECT_EQ(frustum({"plan", graph, "--memory", "none"}).code, 2);
}

TEST(CliPlan, SaysWhatItDoesNotCount) {
  const auto r = frustum({"plan", stages, "--want", "display", "--no-fuse", "--json"});
  ASSERT_EQ(r.code, 0) << r.err;
  const auto rest = json::parse(r.out)["memory"]["not_counted"];
  EXPECT_EQ(rest.back(), "display");
  EXPECT_EQ(std::find(rest.begin(), rest.end(), "hits"), rest.end());
  EXPECT_THAT(frustum({"plan", stages, "--want", "display", "--no-fuse"}).out,
              HasSubstr("; not counted, since pixels feed them whole: points, "));
}

// What one node settles for others stands in the plan: of a camera, the conventions of its API.
TEST(CliPlan, SaysWhichConventionsHold) {
  const std::string graph = std::string(FRUSTUM_SOURCE_DIR) + "/graphs/lessons/02_transform/conventions.json";
  EXPECT_THAT(
      frustum({"plan", graph}).out,
      HasSubstr(
          "\nas camera has it: gl: depth -1 to 1, y of clip space up, the last corner of a face provokes, "
          "corners snap to 1/256 px; standard samples are those of Vulkan and Direct3D, since OpenGL "
          "leaves them open\n"));
  EXPECT_THAT(frustum({"plan", graph, "--set", "conventions=d3d"}).out,
              HasSubstr("d3d: depth 0 to 1, y of clip space up, the first corner"));
  const auto r = frustum({"plan", graph, "--set", "conventions=vulkan", "--set", "camera:reversed_z=true",
                          "--set", "camera:subpixel_bits=4", "--json"});
  ASSERT_EQ(r.code, 0) << r.out << r.err;
  int stated = 0;
  const json plan = json::parse(r.out);
  for (const json& node : plan["nodes"])
    if (node.contains("states")) {
      ++stated;
      EXPECT_EQ(node["id"], "camera");
      EXPECT_EQ(node["states"],
                "vulkan: depth 1 to 0, y of clip space down, the first corner of a face provokes, corners "
                "snap to 1/16 px; standard samples are those of Vulkan and Direct3D");
    }
  EXPECT_EQ(stated, 1);
}

// What is asked for is read by who asks.
TEST(CliInspect, ANodeThatIsLookedAtIsNotCalledUnused) {
  const TempFolder folder;
  const std::string graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "ring": { "type": "mesh.torus" }, "joined": { "type": "mesh.weld", "in": { "mesh": "ring" } },
    "ball": { "type": "mesh.sphere" } },
    "outputs": { "box": { "from": "ball", "file": "ball.ply" } } })");
  EXPECT_THAT(frustum({"inspect", graph, "joined"}).err, Not(HasSubstr("unused_node")));
  const auto other = frustum({"inspect", graph, "ball"});
  EXPECT_EQ(times(other.err, "unused_node"), 1) << other.err << "ring feeds joined, which nobody reads";
  EXPECT_THAT(frustum({"run", graph, "--out", folder.file("o"), "--want", "joined.mesh"}).err,
              Not(HasSubstr("unused_node")));
}

}  // namespace
}  // namespace frustum
