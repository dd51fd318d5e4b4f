// The program as a user meets it: exit codes, what stands on stdout and stderr, files.
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <thread>

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
using testing::IsSupersetOf;
using testing::Not;

const std::string root = FRUSTUM_SOURCE_DIR;
const std::string teapot = root + "/graphs/gallery/teapot.json";
const std::string stages = root + "/graphs/gallery/teapot_stages.json";

std::string text_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// At a size that takes milliseconds.
std::vector<std::string> small(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--set", "resolution=[64, 36]", "--set", "samples=2"});
  return arguments;
}

// The commands that the program's help names.
std::vector<std::string> commands() {
  std::istringstream help(frustum({"--help"}).out);
  std::vector<std::string> out;
  bool inside = false;
  for (std::string line, name; std::getline(help, line);) {
    if (inside && line.empty()) break;
    if (inside && std::istringstream(line) >> name) out.push_back(name);
    inside = inside || line.starts_with("Subcommands");
  }
  return out;
}

TEST(Cli, HelpHasAnExampleForEveryCommand) {
  const auto all = commands();
  EXPECT_THAT(all, IsSupersetOf({"run", "check", "plan", "inspect", "report", "nodes", "diff", "sweep",
                                 "diverge", "stability", "test", "new", "catalog"}));
  for (const std::string& command : all)
    for (const std::vector<std::string>& asked : {std::vector<std::string>{command, "--help"},
                                                  {command, "-h"},
                                                  {"--help", command},
                                                  {command, "--json", "--help"}}) {
      const auto r = frustum(asked);
      EXPECT_EQ(r.code, 0) << command;
      EXPECT_THAT(r.out, AllOf(HasSubstr("Usage: frustum " + command + " ["),
                               HasSubstr("Example:\n  frustum " + command), HasSubstr("--json")))
          << testing::PrintToString(asked);
      EXPECT_THAT(r.err, IsEmpty()) << command;
    }
}

TEST(Cli, HelpForACommandThatDoesNotExistSaysSo) {
  for (const std::vector<std::string>& asked :
       {std::vector<std::string>{"cache", "--help"}, {"--help", "cache"}, {"repotr", "-h"}}) {
    const auto r = frustum(asked);
    EXPECT_EQ(r.code, 2);
    EXPECT_THAT(r.out, IsEmpty());
    EXPECT_THAT(r.err, HasSubstr("no command '"));
  }
  EXPECT_THAT(frustum({"repotr", "--help"}).err, HasSubstr("did you mean 'report'?"));
}

TEST(Cli, NodesShowsWhatThereIsOfATypeAFamilyOrAll) {
  const auto named = [](const std::vector<std::string>& asked, const char* list) {
    std::set<std::string> out;
    const json all = json::parse(frustum(asked).out);
    for (const json& k : all.at(list)) out.insert(k[list == std::string("nodes") ? "type" : "node"]);
    return out;
  };
  const auto of = [](const std::set<std::string>& all, const std::string& family) {
    std::set<std::string> out;
    for (const std::string& name : all)
      if (name.starts_with(family + ".")) out.insert(name);
    return out;
  };
  for (const auto& [flag, list] : {std::pair("--knobs", "knobs"), std::pair("--effects", "effects")}) {
    const auto all = named({"nodes", flag, "--json"}, list);
    EXPECT_GT(all.size(), 10u);
    for (const char* family : {"clip", "rasterize", "shade", "supersample", "vector"}) {
      const auto some = named({"nodes", family, flag, "--json"}, list);
      EXPECT_EQ(some, of(all, family)) << flag << family;
      EXPECT_EQ(named({"nodes", flag, family, "--json"}, list), some) << "in either order";
    }
    EXPECT_EQ(named({"nodes", *all.begin(), flag, "--json"}, list), std::set{*all.begin()});
  }
  EXPECT_THAT(frustum({"nodes", "shade", "--knobs"}).out, Not(HasSubstr("supersample.")));
  const auto none = frustum({"nodes", "vector.make", "--knobs"});
  EXPECT_EQ(none.code, 0);
  EXPECT_THAT(none.out, HasSubstr("no parameter here"));
}

TEST(Cli, NodesNamesTheNearestOfWhatItDoesNotKnow) {
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--knobs"}, {"--effects"}, {"--knobs", "--json"}})
    for (const auto& [wrong, near] :
         {std::pair("cilp", "clip"), std::pair("clip.homogenoeus", "clip.homogeneous")}) {
      std::vector<std::string> asked{"nodes", wrong};
      asked.insert(asked.end(), more.begin(), more.end());
      const auto r = frustum(asked);
      EXPECT_EQ(r.code, 2) << testing::PrintToString(asked);
      EXPECT_THAT(r.out + r.err, AllOf(HasSubstr("unknown_type"), HasSubstr("'" + std::string(wrong) + "'"),
                                       HasSubstr(near)));
    }
}

TEST(Cli, WrongUseIsExit2WithTheNearestName) {
  const auto command = frustum({"runn", "x.json"});
  EXPECT_EQ(command.code, 2);
  EXPECT_THAT(command.err, HasSubstr("did you mean 'run'?"));
  const auto option = frustum({"run", "x.json", "--thraeds", "3"});
  EXPECT_EQ(option.code, 2);
  EXPECT_THAT(option.err, HasSubstr("did you mean '--threads'?"));
  for (const std::vector<std::string>& bad :
       std::vector<std::vector<std::string>>{{},
                                             {"run"},
                                             {"run", teapot, "--set", "samples"},
                                             {"run", teapot, "--region", "1,2,3"},
                                             {"run", teapot, "--region", "0,0,0,5"},
                                             {"run", teapot, "--memory", "lots"},
                                             {"run", teapot, "--frames", "5-2"},
                                             {"run", teapot, "--threads", "-1"},
                                             {"run", teapot, "--precision", "half"},
                                             {"diff", "a"},
                                             {"diff", "a", "b", "--metric", "rsme=1"},
                                             {"new", "Bad"},
                                             {"catalog"},
                                             {"check"},
                                             {"inspect", teapot}}) {
    const auto r = frustum(bad);
    EXPECT_EQ(r.code, 2) << testing::PrintToString(bad) << r.err;
  }
}

TEST(Cli, AnEmptyTextIsNoValue) {
  const std::string picture = root + "/graphs/data/card.png";
  for (const std::vector<std::string>& asked :
       std::vector<std::vector<std::string>>{{"run", teapot, "--out", ""},
                                             {"run", teapot, "--trace", ""},
                                             {"run", ""},
                                             {"check", teapot, ""},
                                             {"inspect", teapot, "camera", "--save", ""},
                                             {"report", teapot, "-o", ""},
                                             {"nodes", ""},
                                             {"diff", "", picture},
                                             {"test", teapot, "--filter", ""},
                                             {"sweep", teapot, "--out", ""}}) {
    const auto r = frustum(asked);
    EXPECT_EQ(r.code, 2) << testing::PrintToString(asked) << r.out;
    EXPECT_THAT(r.out, IsEmpty()) << testing::PrintToString(asked);
  }
  EXPECT_THAT(frustum({"inspect", teapot, "camera", "--save", ""}).err,
              HasSubstr("--save: the text is empty"));
}

TEST(Cli, ARegionMayReachBeyondAllPixels) {
  const auto r =
      frustum(small({"inspect", stages, "display", "--region", "60,30,2147483647,2147483647", "--json"}));
  ASSERT_EQ(r.code, 0) << r.out;
  EXPECT_EQ(json::parse(r.out)["summary"]["window"], json::array({60, 30, 64, 36}));
}

TEST(Cli, DiffNamesTheFileThatIsNone) {
  const auto r = frustum({"diff", root + "/graphs/data/card.png", teapot, "--json"});
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(json::parse(r.out)["diagnostics"][0]["file"], teapot);
}

TEST(Cli, WrongUseCanBeJson) {
  const auto r = frustum({"run", "x.json", "--thraeds", "3", "--json"});
  EXPECT_EQ(r.code, 2);
  EXPECT_EQ(json::parse(r.out)["diagnostics"][0]["suggestions"][0], "--threads");
}

TEST(Cli, AFileThatIsNotThereIsExit3) {
  const auto r = frustum({"check", "none.json", "--json"});
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(json::parse(r.out)["diagnostics"][0]["message"], HasSubstr("none.json"));
  const TempFolder folder;
  folder.write("teapot.json", "{}");
  EXPECT_THAT(frustum({"run", folder.file("teapto.json")}).err,
              HasSubstr("did you mean '" + folder.file("teapot.json") + "'?"));
}

TEST(Cli, CheckNamesEveryProblemAndRunsNothing) {
  const TempFolder folder;
  const auto graph = folder.write("bad.json", R"({"format": "frustum.graph/1", "nodes": {
    "a": {"type": "io.load_patchse"},
    "b": {"type": "scene.camera", "params": {"fov_yy": 3}}}})");
  const auto r = frustum({"check", graph});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.out, IsEmpty());
  EXPECT_THAT(r.err, AllOf(HasSubstr("bad.json:2:"), HasSubstr("did you mean 'io.load_patches'?"),
                           HasSubstr("bad.json:3:"), HasSubstr("did you mean 'fov_y'?")));
  EXPECT_EQ(frustum({"check", teapot, stages}).code, 0);
}

TEST(Cli, RunWritesThePictureAndSaysSo) {
  const TempFolder folder;
  const auto r = frustum(small({"run", teapot, "--out", folder.path()}));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("teapot.png"));
  EXPECT_TRUE(text_of(folder.file("teapot.png")).starts_with("\x89PNG"));
  EXPECT_THAT(r.err, HasSubstr("buffers"));
  EXPECT_THAT(r.err, Not(HasSubstr("\033["))) << "no colours and no progress bar where nobody watches";
}

TEST(Cli, RunAsJsonIsOneObject) {
  const TempFolder folder;
  const auto r = frustum(small({"run", stages, "--out", folder.path(), "--json", "--want", "hits.depth"}));
  ASSERT_EQ(r.code, 0) << r.err;
  const auto out = json::parse(r.out);
  EXPECT_EQ(out["end"], "done");
  EXPECT_THAT(out["files"], IsEmpty());
  EXPECT_EQ(out["ports"]["hits.depth"]["type"], "depth");
  EXPECT_GT(out["peak_bytes"], 0);
}

TEST(Cli, RunRefusesAnUnknownWant) {
  const auto r = frustum({"run", stages, "--want", "hits.dpeth"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("did you mean 'hits.depth'?"));
}

TEST(Cli, RunHasTheSameBytesHoweverItIsRun) {
  const TempFolder folder;
  const auto bytes = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments{"run", teapot, "--out", folder.file("out")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto r = frustum(small(arguments));
    EXPECT_EQ(r.code, 0) << r.err;
    return text_of(folder.file("out/teapot.png"));
  };
  const auto expected = bytes({});
  EXPECT_EQ(bytes({"--threads", "1", "--tile", "16"}), expected);
  EXPECT_EQ(bytes({"--threads", "7", "--no-fuse"}), expected);
  EXPECT_EQ(bytes({"--simd", "sse4"}), expected);
}

TEST(Cli, EventsAreJsonLinesAndTheTraceIsOneObject) {
  const TempFolder folder;
  const auto r = frustum(
      small({"run", teapot, "--out", folder.path(), "--events", "--json", "--trace", folder.file("t.json")}));
  ASSERT_EQ(r.code, 0) << r.err;
  std::istringstream lines(r.err);
  int done = 0;
  for (std::string line; std::getline(lines, line);) done += json::parse(line)["event"] == "done" ? 1 : 0;
  EXPECT_GT(done, 5);
  const auto trace = json::parse(text_of(folder.file("t.json")));
  const auto& events = trace["traceEvents"];
  EXPECT_TRUE(std::any_of(events.begin(), events.end(),
                          [](const json& e) { return e["ph"] == "X" && e["cat"] == "pixels"; }));
  EXPECT_TRUE(std::any_of(events.begin(), events.end(), [](const json& e) { return e["ph"] == "C"; }));
}

TEST(Cli, RepeatPrintsTheTimesOfEveryStep) {
  const auto r = frustum(small({"run", stages, "--want", "display", "--repeat", "3", "--json"}));
  ASSERT_EQ(r.code, 0) << r.err;
  const auto steps = json::parse(r.out)["steps"];
  EXPECT_TRUE(std::any_of(steps.begin(), steps.end(),
                          [](const json& s) { return s["step"] == "mesh" && s["runs"] == 3; }));
  EXPECT_EQ(steps.back()["step"], "whole run");
}

TEST(Cli, PlanSaysWhatRunsAndWhatDoesNot) {
  const auto r = frustum({"plan", stages, "--want", "hits.depth", "--json"});
  ASSERT_EQ(r.code, 0) << r.err;
  const auto plan = json::parse(r.out);
  const auto& skipped = plan["skipped"];
  for (const char* node : {"lit", "pixels", "display", "key"})
    EXPECT_NE(std::find(skipped.begin(), skipped.end(), node), skipped.end()) << node;
  EXPECT_THAT(frustum({"plan", stages}).out,
              AllOf(HasSubstr("one pass over tiles"), HasSubstr("streams to output 'beauty'")));
}

TEST(Cli, InspectShowsStatisticsValuesAndTables) {
  const auto summary = frustum(small({"inspect", stages, "hits.depth"}));
  ASSERT_EQ(summary.code, 0) << summary.err;
  EXPECT_THAT(summary.out, HasSubstr("port: hits.depth"));
  const auto pixel = frustum(small({"inspect", stages, "lit", "--pixel", "32,18", "--json"}));
  ASSERT_EQ(pixel.code, 0) << pixel.err;
  EXPECT_EQ(json::parse(pixel.out)["pixel"]["samples"].size(), 2u);
  EXPECT_THAT(frustum(small({"inspect", stages, "mesh", "--table", "--rows", "2"})).out,
              HasSubstr("rows in all"));
  EXPECT_EQ(frustum(small({"inspect", stages, "lit", "--pixel", "64,18"})).code, 2) << "outside";
  EXPECT_EQ(frustum(small({"inspect", stages, "mesh", "--pixel", "0,0"})).code, 2) << "no pixels";
}

TEST(Cli, ProvenanceLeadsFromThePictureToTheNodeThatMadeTheTriangle) {
  const auto r = frustum(small({"inspect", stages, "display", "--provenance", "32,20", "--json"}));
  ASSERT_EQ(r.code, 0) << r.err;
  const auto p = json::parse(r.out);
  EXPECT_EQ(p["samples"], 2);
  EXPECT_EQ(p["made_by"]["node"], "mesh");
  EXPECT_EQ(p["made_by"]["type"], "surface.tessellate");
  ASSERT_FALSE(p["triangles"].empty()) << "the teapot covers the middle of the picture";
  EXPECT_EQ(p["triangles"][0]["path"].back()["port"], "mesh.mesh");
  EXPECT_EQ(p["triangles"][0]["path"].back()["first"], p["triangles"][0]["source_triangle"]);
}

TEST(Cli, DiffJudgesTwoFiles) {
  const TempFolder folder;
  ASSERT_EQ(frustum(small({"inspect", stages, "pixels", "--save", folder.file("a.exr")})).code, 0);
  ASSERT_EQ(frustum(small({"inspect", stages, "pixels", "--set", "clay:shininess=30", "--save",
                           folder.file("b.exr")}))
                .code,
            0);
  EXPECT_EQ(frustum({"diff", folder.file("a.exr"), folder.file("a.exr")}).code, 0);
  const auto r = frustum({"diff", folder.file("a.exr"), folder.file("b.exr"), "--json"});
  EXPECT_EQ(r.code, 1);
  const auto d = json::parse(r.out);
  EXPECT_GT(d["max"], 0);
  EXPECT_EQ(frustum({"diff", folder.file("a.exr"), folder.file("b.exr"), "--metric", "max=1e6"}).code, 0);
  EXPECT_EQ(frustum({"diff", folder.file("a.exr"), folder.file("none.exr")}).code, 3);
  EXPECT_THAT(frustum({"diff", folder.file("a.exr"), folder.file("b.exr"), "--metric", "identical"}).out,
              HasSubstr("does not hold: identical"));
}

// A picture of minutes is interrupted after a moment.
TEST(Cli, AnInterruptedRunLeavesNoFileAndExits130) {
  const TempFolder folder;
  const std::string program = test::frustum_program();
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::string out = folder.file("out");
    ::execl(program.c_str(), "frustum", "run", teapot.c_str(), "--out", out.c_str(), "--set",
            "resolution=[16384, 16384]", "--set", "samples=16", "--json", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  ASSERT_EQ(::kill(child, SIGINT), 0);
  const auto asked = std::chrono::steady_clock::now();
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_LT(std::chrono::steady_clock::now() - asked, std::chrono::seconds(20));
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  if (std::filesystem::exists(folder.file("out"))) {
    EXPECT_TRUE(std::filesystem::is_empty(folder.file("out"))) << "neither a picture nor a temporary file";
  }
}

}  // namespace
}  // namespace frustum
