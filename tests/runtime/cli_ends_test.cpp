// How the program ends when something is in its way: a run that fails or is interrupted, output that is
// lost, files that are none.
#include "runtime/app/files.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace frustum {
namespace {

using nlohmann::json;
using test::frustum;
using test::ProcessResult;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::string root = FRUSTUM_SOURCE_DIR;
const std::string teapot = root + "/graphs/gallery/teapot.json";
const std::string stages = root + "/graphs/gallery/teapot_stages.json";

std::string graph_with(const std::string& nodes, const std::string& outputs, const std::string& more = "") {
  return R"({ "format": "frustum.graph/1", )" + more + R"("nodes": { )" + nodes + R"( }, "outputs": { )" +
         outputs + " } }";
}

// Which materials a mesh has is known only when it is there.
const std::string failing = graph_with(
    R"("box": { "type": "mesh.box" }, "clay": { "type": "shade.material" },
       "a": { "type": "mesh.assign_material", "in": { "mesh": "box", "material": "clay" },
              "params": { "instead_of": "gold" } })",
    R"("o": { "from": "a" })");

ProcessResult shell(const std::string& line) { return test::run_process({"/bin/sh", "-c", line}); }

std::string quoted(const std::string& path) { return "'" + path + "'"; }

std::vector<std::string> codes(const json& out) {
  std::vector<std::string> all;
  for (const json& d : out.at("diagnostics")) all.push_back(d["code"]);
  return all;
}

// ----- runs that do not reach their end

TEST(CliEnds, AFailedRunThatWantsAPortSaysWhy) {
  const TempFolder folder;
  const auto graph = folder.write("g.json", failing);
  for (const auto& want : std::vector<std::vector<std::string>>{{}, {"--want", "a"}, {"--want", "o"}}) {
    std::vector<std::string> text{"run", graph};
    text.insert(text.end(), want.begin(), want.end());
    const auto said = frustum(text);
    EXPECT_EQ(said.code, 2) << said.err;
    EXPECT_THAT(said.err, AllOf(HasSubstr("error[unknown_material]"), HasSubstr("/nodes/a")));
    EXPECT_THAT(said.out, IsEmpty());
    text.emplace_back("--json");
    const auto object = frustum(text);
    EXPECT_EQ(object.code, 2);
    const auto out = json::parse(object.out);
    EXPECT_EQ(codes(out), std::vector<std::string>{"unknown_material"});
    EXPECT_EQ(out["end"], "failed");
    EXPECT_THAT(out["ports"], IsEmpty());
  }
}

TEST(CliEnds, ARunRefusedForItsMemorySaysSo) {
  const std::vector<std::string> run{"run", stages, "--want", "display", "--want", "mesh", "--memory", "1K"};
  const auto text = frustum(run);
  EXPECT_EQ(text.code, 2) << text.err;
  EXPECT_THAT(text.err, HasSubstr("error[memory]"));
  auto with_json = run;
  with_json.emplace_back("--json");
  const auto object = frustum(with_json);
  EXPECT_EQ(object.code, 2);
  EXPECT_THAT(codes(json::parse(object.out)),
              testing::AllOf(testing::Not(testing::IsEmpty()), testing::Each("memory")))
      << "nodes that run side by side may both be refused";
}

struct Interrupted {
  int code;
  std::string out, err;
};

// Starts a program that takes minutes, waits until it is at work (until `sign`, if given, holds), and sends it
// a signal, `times` times a millisecond apart: those that come before the first is handled count as one.
Interrupted interrupted(std::vector<std::string> arguments, int signal, const TempFolder& folder,
                        int times = 1, const std::function<bool()>& sign = {},
                        const std::vector<std::string>& more = {"--set", "resolution=[2048, 2048]", "--set",
                                                                "samples=256"}) {
  std::string line = "exec " + quoted(test::frustum_program());
  arguments.insert(arguments.end(), more.begin(), more.end());
  for (const std::string& a : arguments) line += " " + quoted(a);
  line += " >" + quoted(folder.file("said")) + " 2>" + quoted(folder.file("warned"));
  const pid_t child = ::fork();
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", line.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  if (!sign) std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  for (int i = 0; sign && !sign() && i < 3000; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  for (int i = 0; i < times; ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ::kill(child, signal);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  const auto text = [&](const char* name) { return shell("cat " + quoted(folder.file(name))).out; };
  return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text("said"), text("warned")};
}

TEST(CliEnds, AnInterruptedRunThatWantsAPortExits130) {
  const TempFolder folder;
  const auto text = interrupted({"run", stages, "--want", "display", "--want", "camera"}, SIGINT, folder);
  EXPECT_EQ(text.code, 130) << text.err;
  EXPECT_THAT(text.err, HasSubstr("cancelled"));
  const auto object = interrupted({"run", stages, "--want", "display", "--json"}, SIGTERM, folder);
  EXPECT_EQ(object.code, 130) << object.err;
  EXPECT_EQ(json::parse(object.out)["end"], "cancelled");
}

TEST(CliEnds, InspectThatIsInterruptedSaysSo) {
  const TempFolder folder;
  const auto r = interrupted({"inspect", stages, "display"}, SIGINT, folder);
  EXPECT_EQ(r.code, 130) << r.err;
  EXPECT_THAT(r.err, HasSubstr("cancelled"));
}

TEST(CliEnds, ATerminalThatGoesAwayLeavesNoTemporaryFile) {
  const TempFolder folder;
  const auto begun = [&] { return std::filesystem::exists(folder.file("out")); };
  const auto r = interrupted({"run", teapot, "--out", folder.file("out")}, SIGHUP, folder, 1, begun);
  EXPECT_EQ(r.code, 130) << r.err;
  EXPECT_FALSE(std::filesystem::exists(folder.file("out"))) << "nor the folder that was made for it";
}

// The second signal ends the process where it stands, in the middle of a file.
TEST(CliEnds, ASecondInterruptLeavesNoTemporaryFile) {
  const TempFolder folder;
  const std::string out = folder.file("out");
  const auto begun = [&] { return std::filesystem::exists(out) && !std::filesystem::is_empty(out); };
  const auto r = interrupted({"run", teapot, "--out", out}, SIGINT, folder, 5, begun);
  EXPECT_EQ(r.code, 130) << r.err;
  if (std::filesystem::exists(out)) {
    EXPECT_TRUE(std::filesystem::is_empty(out));
  }
}

std::string sphere(const std::string& file, int segments, int rings) {
  return graph_with(R"("s": { "type": "mesh.sphere", "params": { "segments": )" + std::to_string(segments) +
                        R"(, "rings": )" + std::to_string(rings) + " } }",
                    R"("o": { "from": "s", "file": ")" + file + R"(" })");
}

// The interrupt comes when the file has been begun, of which most is still to be written.
TEST(CliEnds, AnInterruptWhileAMeshOrATableIsWrittenLeavesNoFile) {
  for (const std::string file : {"m.ply", "m.obj", "m.gltf", "m.csv", "m.json"}) {
    const TempFolder folder;
    const auto graph = folder.write("g.json", sphere(file, 4096, 512));
    const std::string out = folder.file("out");
    const auto begun = [&] { return std::filesystem::exists(out) && !std::filesystem::is_empty(out); };
    const auto r = interrupted({"run", graph, "--out", out}, SIGINT, folder, 1, begun, {});
    EXPECT_EQ(r.code, 130) << file << r.err;
    EXPECT_THAT(r.err, HasSubstr("cancelled")) << file;
    EXPECT_FALSE(std::filesystem::exists(out)) << file;
  }
}

TEST(CliEnds, AnInterruptWhileInspectSavesLeavesNoFile) {
  const TempFolder folder;
  const auto graph = folder.write("g.json", sphere("m.ply", 2048, 512));
  const std::string out = folder.file("out");
  std::filesystem::create_directory(out);
  const auto begun = [&] { return !std::filesystem::is_empty(out); };
  const auto r = interrupted({"inspect", graph, "s", "--save", out + "/m.csv"}, SIGINT, folder, 1, begun, {});
  EXPECT_EQ(r.code, 130) << r.err;
  EXPECT_TRUE(std::filesystem::is_empty(out));
}

// The sphere has 48 MiB, and its vertices must be split: coordinates are of corners.
TEST(CliEnds, WhatSavingAMeshTakesCountsAsMemory) {
  const TempFolder folder;
  const std::string out = folder.file("out");
  for (const std::string file : {"m.ply", "m.glb"}) {
    const auto graph = folder.write("g.json", sphere(file, 1024, 512));
    for (const auto& command : {std::vector<std::string>{"run", graph, "--out", out},
                                {"inspect", graph, "s", "--save", out + "/" + file}}) {
      auto arguments = command;
      arguments.insert(arguments.end(), {"--memory", "60M"});
      const auto refused = frustum(arguments);
      EXPECT_EQ(refused.code, 2) << refused.err;
      EXPECT_THAT(refused.err, AllOf(HasSubstr("error[memory]"), HasSubstr("above the limit of 60")));
      EXPECT_FALSE(std::filesystem::exists(out + "/" + file));
      arguments.back() = "140M";
      EXPECT_EQ(frustum(arguments).code, 0) << file;
      EXPECT_TRUE(std::filesystem::remove(out + "/" + file)) << file;
    }
  }
}

// A pass writes its files side by side: the one that cannot be written is named, not the first of them.
TEST(CliEnds, TheOutputThatCannotBeWrittenIsNamed) {
  const TempFolder folder;
  const std::string image = R"("i": { "type": "io.load_image", "params": { "file": ")" + root +
                            R"(/tests/bad/parts/pixels.png" } })";
  const auto graph = folder.write("g.json", graph_with(image, R"("good": { "from": "i", "file": "good.png" },
    "bad": { "from": "i", "file": "bad.png" }, "last": { "from": "i", "file": "last.png" })"));
  std::filesystem::create_directories(folder.file("out/bad.png"));
  const auto r = frustum({"run", graph, "--out", folder.file("out"), "--json"});
  EXPECT_EQ(r.code, 3);
  const auto d = json::parse(r.out)["diagnostics"][0];
  EXPECT_EQ(d["code"], "cannot_write_file");
  EXPECT_EQ(d["pointer"], "/outputs/bad/file");
  EXPECT_GT(d["line"], 0);
}

// ----- output that nobody gets

TEST(CliEnds, OutputThatIsLostIsExit3) {
  const std::string program = quoted(test::frustum_program());
  const std::string check = " check " + quoted(stages);
  for (const std::string& command :
       {std::string(" nodes --json"), check, std::string(" --help"), std::string(" --version")}) {
    const auto full = shell(program + command + " >/dev/full");
    EXPECT_EQ(full.code, 3) << command;
    EXPECT_THAT(full.err, HasSubstr("cannot write to the standard output: No space left on device"))
        << command;
    EXPECT_EQ(shell(program + command + " >&-").code, 3) << command;
  }
}

TEST(CliEnds, AReaderThatWentAwayIsNoFailure) {
  const auto r =
      shell("(" + quoted(test::frustum_program()) + " nodes --json; echo $? >&2) | head -c 1 >/dev/null");
  EXPECT_EQ(r.err, "0\n");
}

// The numbers of closed streams go to the next files: what is said must not end in one of these.
TEST(CliEnds, ClosedStreamsDoNotBecomeFiles) {
  const TempFolder folder;
  const auto r = shell(quoted(test::frustum_program()) + " run " + quoted(teapot) +
                       " --set 'resolution=[64, 36]' --out " + quoted(folder.path()) + " <&- >&- 2>&-");
  EXPECT_EQ(r.code, 3);
  EXPECT_EQ(shell("head -c 4 " + quoted(folder.file("teapot.png"))).out, "\x89PNG");
}

// ----- files that are none

TEST(CliEnds, PipesAndDevicesAreRefusedAtOnce) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo(folder.file("pipe.obj").c_str(), 0600), 0);
  const auto graph =
      folder.write("g.json", graph_with(R"("i": { "type": "io.load_image", "params": { "file": "pipe" } })",
                                        R"("o": { "from": "i" })"));
  const auto mesh = folder.write(
      "m.json", graph_with(R"("i": { "type": "io.load_mesh", "params": { "file": "pipe.obj" } })",
                           R"("o": { "from": "i" })"));
  for (const std::string& named : {graph, mesh}) {
    const auto r = frustum({"run", named});
    EXPECT_EQ(r.code, 2) << "a mistake of the graph" << r.err;
    EXPECT_THAT(r.err, AllOf(HasSubstr("missing_file"), HasSubstr("not a regular file"))) << r.err;
  }
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"check", folder.file("pipe")},
                                             {"check", "/dev/zero"},
                                             {"diff", folder.file("pipe"), folder.file("pipe")}}) {
    const auto r = frustum(command);
    EXPECT_EQ(r.code, 3) << testing::PrintToString(command) << r.err;
    EXPECT_THAT(r.err, AllOf(HasSubstr("cannot_read_file"), HasSubstr("not a regular file"))) << r.err;
  }
  EXPECT_THAT(frustum({"check", folder.path()}).err, HasSubstr("Is a directory"));
  EXPECT_THAT(frustum({"check", folder.file("none")}).err, HasSubstr("No such file or directory"));
}

TEST(CliEnds, AFileDoesNotTakeThePlaceOfADevice) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  for (const char* option : {"--trace", "--save"}) {
    std::vector<std::string> command{"run", stages, "--want", "camera"};
    if (option == std::string("--save")) command = {"inspect", stages, "camera"};
    const auto made = folder.file(option == std::string("--save") ? "pipe.csv" : "pipe");
    if (option == std::string("--save")) std::filesystem::rename(folder.file("pipe"), made);
    command.insert(command.end(), {option, made});
    const auto r = frustum(command);
    EXPECT_NE(r.code, 0) << option;
    EXPECT_TRUE(std::filesystem::is_fifo(made)) << option;
  }
}

TEST(CliEnds, CheckGoesOnAfterAFileThatCannotBeRead) {
  const TempFolder folder;
  const auto r = frustum({"check", folder.file("none"), folder.write("g.json", failing)});
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, HasSubstr("none"));
  EXPECT_THAT(r.out, HasSubstr("g.json: 3 nodes, 1 outputs, no errors"));
}

TEST(CliEnds, AFileThatCannotBeWrittenIsKnownBeforeAnythingRuns) {
  const TempFolder folder;
  folder.write("broken.obj", "v 0 zero 0");
  folder.write("file", "");
  const auto graph = folder.write(
      "g.json", graph_with(R"("m": { "type": "io.load_mesh", "params": { "file": "broken.obj" } })",
                           R"("o": { "from": "m" })"));
  for (const auto& command :
       std::vector<std::vector<std::string>>{{"inspect", graph, "m", "--save", folder.file("file/x.obj")},
                                             {"report", graph, "-o", folder.file("file/x.html")},
                                             {"run", graph, "--trace", folder.file("file/x.json")}}) {
    const auto r = frustum(command);
    EXPECT_EQ(r.code, 3) << testing::PrintToString(command);
    EXPECT_THAT(r.err, AllOf(HasSubstr("cannot_write_file"), Not(HasSubstr("malformed_file"))));
  }
  EXPECT_EQ(frustum({"report", graph, "-o", folder.file("new/x.html")}).code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder.file("new"))) << "what was tried leaves nothing";
}

// ----- frames

TEST(CliEnds, FramesThatWouldWriteOverEachOtherAreRefused) {
  const TempFolder folder;
  folder.write("broken.exr", "no picture");
  const auto frames = [&](const std::string& file, const std::string& params, const std::string& range) {
    const auto graph = folder.write(
        "f.json", graph_with(R"("c": { "type": "scene.camera", "params": { "resolution": [4, 4] } },
                               "m": { "type": "io.load_image", "params": { "file": "broken.exr" } })",
                             R"("o": { "from": "m", "file": ")" + file + "\" }", params));
    return frustum({"run", graph, "--frames", range, "--out", folder.file("out")});
  };
  const auto same = frames("a.exr", R"("params": { "frame": 1 }, )", "1-3");
  EXPECT_EQ(same.code, 2);
  EXPECT_THAT(same.err, AllOf(HasSubstr("error[file_without_frame]"), HasSubstr("/outputs/o/file")));
  const std::string text = read_text(folder.file("f.json"));
  const std::size_t at = text.find("\"a.exr\""), line = text.rfind('\n', at);
  EXPECT_THAT(same.err, HasSubstr("f.json:2:" + std::to_string(at - line) + " "));
  EXPECT_THAT(same.err, Not(HasSubstr("broken.exr"))) << "nothing ran";
  EXPECT_THAT(frames("a.exr", R"("params": { "frame": 1 }, )", "3").err,
              Not(HasSubstr("file_without_frame")));
  EXPECT_THAT(frames("a{frame}.exr", "", "1-3").err,
              AllOf(HasSubstr("warning[no_frame_parameter]"), Not(HasSubstr("file_without_frame"))));
  EXPECT_EQ(frames("a{frame}.exr", "", "1-2147483647").code, 2);
}

// "o{frame}.json" is another name than "o0003.json" until the frame is known.
TEST(CliEnds, AFrameThatIsAnotherOutputsNameIsRefused) {
  const TempFolder folder;
  const auto graph = folder.write("g.json", graph_with(R"("box": { "type": "mesh.box" })",
                                                       R"("o": { "from": "box", "file": "o{frame}.ply" },
    "three": { "from": "box", "file": "o0003.ply" }, "zero": { "from": "box", "file": "./o0000.ply" })"));
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"run", graph, "--out", folder.file("out"), "--json"});
    return frustum(more);
  };
  const auto expect_refused = [&](const std::vector<std::string>& more, const std::string& pointer) {
    const auto r = run(more);
    EXPECT_EQ(r.code, 2) << r.out;
    const json d = json::parse(r.out)["diagnostics"].back();
    EXPECT_EQ(d["code"], "duplicate_file");
    EXPECT_EQ(d["pointer"], pointer);
    EXPECT_EQ(d["related"][0]["pointer"], "/outputs/o/file");
    EXPECT_GT(d["related"][0]["column"], 0);
    EXPECT_FALSE(std::filesystem::exists(folder.file("out"))) << "nothing ran";
  };
  expect_refused({"--frames", "3"}, "/outputs/three/file");
  expect_refused({}, "/outputs/zero/file");
  EXPECT_EQ(run({"--frames", "3", "--want", "o", "--want", "zero"}).code, 0);
}

// ----- what is said

TEST(CliEnds, IdsAreIntegersAndNoFaceIsNone) {
  const std::vector<std::string> inspect{
      "inspect", stages, "hits", "--pixel", "0,0", "--set", "resolution=[64, 36]", "--set", "samples=2"};
  const auto text = frustum(inspect);
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_THAT(text.out, AllOf(HasSubstr("none"), Not(HasSubstr("e+09"))));
  auto as_json = inspect;
  as_json.emplace_back("--json");
  const auto out = json::parse(frustum(as_json).out);
  EXPECT_TRUE(out["pixel"]["samples"][0]["id"].is_null());
  EXPECT_TRUE(out.contains("diagnostics"));
  as_json[4] = "32,20";
  EXPECT_TRUE(json::parse(frustum(as_json).out)["pixel"]["samples"][0]["id"].is_number_integer());
}

TEST(CliEnds, FamiliesVersionsAndHelpAreFound) {
  const auto family = frustum({"nodes", "clip"});
  EXPECT_EQ(family.code, 0);
  EXPECT_THAT(family.out, AllOf(HasSubstr("clip.homogeneous"), Not(HasSubstr("light."))));
  EXPECT_EQ(frustum({"nodes", "clap"}).code, 2);
  EXPECT_TRUE(json::parse(frustum({"--json", "--version"}).out).contains("version"));
  EXPECT_THAT(frustum({"run", teapot, "--region", "1,2,3"}).err, HasSubstr("frustum run --help"));
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{"run", teapot, "--region", "0,0,5,5,"},
                                             {"inspect", stages, "mesh", "--table", "--first=-1"},
                                             {"inspect", stages, "mesh", "--table", "--rows=0"}})
    EXPECT_EQ(frustum(bad).code, 2) << testing::PrintToString(bad);
}

TEST(CliEnds, ATimeoutIsAboveZero) {
  const std::string suite = root + "/tests/suites/gallery.json";
  for (const std::string wrong : {"-1", "0", "nan", "inf", "soon"}) {
    const auto r = frustum({"test", suite, "--timeout", wrong});
    EXPECT_EQ(r.code, 2) << wrong;
    EXPECT_THAT(r.err, HasSubstr("must be above 0, not " + wrong));
    EXPECT_LT(r.err.size(), 200u) << "no digits of the greatest double";
  }
}

}  // namespace
}  // namespace frustum
