// What `frustum sweep` and `frustum test` say before anything runs: knobs that say nothing, folders that are taken,
// results that cannot be written.
#include "runtime/app/files.h"
#include "runtime/app/sweep/journal.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace frustum {
namespace {

namespace fs = std::filesystem;
using test::frustum;
using testing::HasSubstr;

struct Lamp {
  test::TempFolder folder;
  std::string graph = folder.write("g.json", R"({ "format": "frustum.graph/1",
    "params": { "n": 4 },
    "nodes": { "lamp": { "type": "light.area", "params": { "samples": "$n" } } },
    "outputs": { "lamp": { "from": "lamp" } } })");
  std::string out = folder.file("out");
  test::ProcessResult sweep(std::vector<std::string> more) const {
    std::vector<std::string> all{"sweep", graph, "--repeats", "1"};
    all.insert(all.end(), more.begin(), more.end());
    return frustum(all);
  }
};

TEST(SweepCli, KnobsSayAllTheirValuesOnce) {
  const Lamp s;
  for (const auto& [knobs, text] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--knob", "n=1,,4"}, "a value is empty"},
           {{"--knob", "n="}, "a value is empty"},
           {{"--knob", "n=1,4", "--knob", "n=4,16"}, "it is turned already"},
           {{"--knob", "n=4"}, "at least two"}}) {
    auto command = knobs;
    command.insert(command.end(), {"-o", s.out});
    const auto r = s.sweep(command);
    EXPECT_EQ(r.code, 2) << r.err;
    EXPECT_THAT(r.err, HasSubstr("error[bad_knob]"));
    EXPECT_THAT(r.err, HasSubstr(text));
    EXPECT_FALSE(fs::exists(s.out));
  }
  EXPECT_EQ(s.sweep({"--knob", "n=1,4", "-o", ""}).code, 2) << "no folder at all";
}

TEST(SweepCli, TwoSweepsDoNotShareAFolder) {
  const Lamp s;
  {
    const SweepJournal other(fs::path(s.out) / "points.jsonl", "other", false);
    const auto r = s.sweep({"--knob", "n=1,4", "-o", s.out});
    EXPECT_EQ(r.code, 2) << r.err;
    EXPECT_THAT(r.err, HasSubstr("error[folder_in_use]"));
    EXPECT_THAT(read_text(fs::path(s.out) / "points.jsonl"), HasSubstr("other"));
  }
  EXPECT_NO_THROW(SweepJournal(fs::path(s.out) / "points.jsonl", "next", false)) << "it has gone";
}

TEST(SweepCli, FilesAreTriedBeforeAnythingRuns) {
  for (const char* taken : {"sweep.html", "sweep.json", "points.jsonl"}) {
    const Lamp s;
    fs::create_directories(fs::path(s.out) / taken);
    const auto r = s.sweep({"--knob", "n=1,4", "-o", s.out});
    EXPECT_EQ(r.code, 3) << r.err;
    EXPECT_THAT(r.err, HasSubstr("not a regular file"));
    EXPECT_EQ(std::distance(fs::directory_iterator(s.out), fs::directory_iterator()), 1)
        << "nothing was made";
  }
  const Lamp s;
  fs::create_directory(s.out);
  write_text(fs::path(s.out) / "pictures", "a file where a folder should be");
  const auto r = s.sweep({"--knob", "n=1,4", "-o", s.out});
  EXPECT_EQ(r.code, 3) << r.err;
  EXPECT_THAT(r.err, HasSubstr("error[cannot_write_file]"));
}

// A node that warns stands before one that fails: the error is what ends the command, at its place, and is told once.
TEST(SweepCli, ARunThatFailsKeepsItsPlaceAndItsCode) {
  const test::TempFolder folder;
  folder.write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");  // no normals: a warning
  const auto graph =
      folder.write("g.json", R"({ "format": "frustum.graph/1", "params": { "unused": 1 }, "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "m.obj" } }, "clay": { "type": "shade.material" },
    "red": { "type": "mesh.assign_material", "in": { "mesh": "m", "material": "clay" },
             "params": { "instead_of": "gold" } } }, "outputs": { "o": { "from": "red" } } })");
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"sweep", graph, "--knob", "precision=single,double", "-o",
                                 folder.file("out")},
        {"diverge", graph}}) {
    const auto r = frustum(command);
    EXPECT_EQ(r.code, 2) << r.out;
    EXPECT_THAT(r.err, HasSubstr("error[unknown_material] " + graph + ":4:40 /nodes/red/params/instead_of"));
  }
  const auto wrong = frustum({"sweep", graph, "--knob", "nope=1,2", "-o", folder.file("out")});
  EXPECT_EQ(wrong.code, 2);
  const auto first = wrong.err.find("unused_parameter");
  ASSERT_NE(first, std::string::npos) << wrong.err;
  EXPECT_EQ(wrong.err.find("unused_parameter", first + 1), std::string::npos) << wrong.err;
}

struct OneCase {
  test::TempFolder folder;
  std::string suite = folder.write(
      "s.json", R"({ "format": "frustum.suite/1", "cases": [ { "id": "a", "graph": "g.json" } ] })");
  std::string graph = folder.write("g.json", R"({ "format": "frustum.graph/1",
    "nodes": { "box": { "type": "mesh.box" } }, "outputs": { "box": { "from": "box" } } })");
};

TEST(TestCli, ShardsAreTwoWholeNumbers) {
  const OneCase c;
  for (const char* shard :
       {"3/2", "0/2", "1/0", "-1/2", "1/2/3", "x", "1/", "/2", "1.5/2", "2/99999999999", "1 /2"}) {
    const auto r = frustum({"test", c.suite, "--shard", shard});
    EXPECT_EQ(r.code, 2) << shard << r.out << r.err;
    EXPECT_THAT(r.err, testing::AnyOf(HasSubstr("expected I/N"), HasSubstr("parts 1 to N")));
  }
  EXPECT_EQ(frustum({"test", c.suite, "--shard", "1/1"}).code, 0);
}

TEST(TestCli, ResultsAreTriedBeforeAnythingRuns) {
  const OneCase c;
  for (const char* option : {"--junit", "--html"})
    for (const std::string& file :
         {std::string("/dev/full"), std::string("/proc/none/r"), c.folder.path(), c.graph + "/r"}) {
      const auto r = frustum({"test", c.suite, option, file});
      EXPECT_EQ(r.code, 3) << file << r.err;
      EXPECT_THAT(r.err, HasSubstr("error[cannot_write_file]"));
      EXPECT_EQ(r.out, "") << "no case ran";
    }
}

TEST(TestCli, ASuiteRunsOnce) {
  const OneCase c;
  const auto r = frustum({"test", c.suite, c.folder.file("./s.json")});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, HasSubstr("is given twice"));
}

TEST(TestCli, ReportsOneCheckAsOne) {
  const OneCase c;
  EXPECT_THAT(frustum({"test", c.suite}).out, HasSubstr("(1 check, "));
}

}  // namespace
}  // namespace frustum
