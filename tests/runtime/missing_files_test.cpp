// Files that a graph names and that are not there: the user's mistake, found before anything runs, at the value that names
// them.
#include "runtime/app/session.h"
#include "runtime/core/error.h"
#include "runtime/core/missing_file.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>

#include <sys/stat.h>

namespace frustum {
namespace {

using nlohmann::json;
using test::frustum;
using test::TempFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

// Three files, on lines 4 to 6, each a value in column 56.
constexpr auto three = R"({ "format": "frustum.graph/1",
  "params": { "model": "teapto.obj" },
  "nodes": {
    "m": { "type": "io.load_mesh",  "params": { "file": "teapto.obj" } },
    "p": { "type": "io.load_image", "params": { "file": "none.png" } },
    "g": { "type": "graph",                     "file": "inenr.json" } },
  "outputs": { "mesh": { "from": "m" }, "picture": { "from": "p" }, "inner": { "from": "g" },
               "set": { "from": "m" } } })";

constexpr auto inner = R"({ "format": "frustum.graph/1", "nodes": { "c": { "type": "scene.camera" } },
  "outputs": { "camera": { "from": "c" } } })";

struct Found {
  std::string pointer, message, suggestion;
  int line, column;
};

std::vector<Found> missing(const json& answer) {
  std::vector<Found> out;
  for (const json& d : answer["diagnostics"])
    if (d["code"] == "missing_file")
      out.push_back({d["pointer"], d["message"], d["suggestions"].empty() ? "" : d["suggestions"][0],
                     d["line"], d["column"]});
  return out;
}

TEST(MissingFiles, AreAllFoundAtTheirValuesBeforeAnythingRuns) {
  const TempFolder folder;
  folder.write("teapot.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("inner.json", inner);
  const auto graph = folder.write("g.json", three);
  for (const char* command : {"check", "run", "plan"}) {
    const auto r = frustum({command, graph, "--json"});
    EXPECT_EQ(r.code, 2) << command << r.out;
    const auto found = missing(json::parse(r.out));
    ASSERT_EQ(found.size(), 3u) << command << r.out;
    const char* const pointers[] = {"/nodes/m/params/file", "/nodes/p/params/file", "/nodes/g/file"};
    const char* const near[] = {"teapot.obj", "", "inner.json"};
    for (int i = 0; i < 3; ++i) {
      const Found& f = found[static_cast<std::size_t>(i)];
      EXPECT_EQ(f.pointer, pointers[i]);
      EXPECT_EQ(f.suggestion, near[i]);
      EXPECT_EQ(f.line, 4 + i);
      EXPECT_EQ(f.column, 57) << "the value, and not its key";
      EXPECT_THAT(f.message, HasSubstr("there is no file '"));
    }
  }
}

TEST(MissingFiles, SayThatTheNameCameFromOutside) {
  const TempFolder folder;
  folder.write("here.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const auto graph =
      folder.write("g.json", R"({ "format": "frustum.graph/1", "params": { "model": "here.obj" }, "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "$model" } } }, "outputs": { "o": { "from": "m" } } })");
  EXPECT_EQ(frustum({"run", graph}).code, 0);
  for (const char* setting : {"m:file=there.obj", "model=there.obj"}) {
    const auto r = frustum({"run", graph, "--set", setting});
    EXPECT_EQ(r.code, 2);
    EXPECT_THAT(r.err, AllOf(HasSubstr("error[missing_file]"), HasSubstr("g.json:2:56 /nodes/m/params/file"),
                             HasSubstr("(from --set " + std::string(setting) + ")"),
                             HasSubstr("did you mean 'here.obj'?")));
  }
}

// What only the run can find out stands at the same place, with the same words.
TEST(MissingFiles, AFileThatIsBrokenSaysSoToo) {
  const TempFolder folder;
  folder.write("here.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("broken.obj", "v 0 zero 0\n");
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "m": { "type": "io.load_mesh", "params": { "file": "here.obj" } } }, "outputs": { "o": { "from": "m" } } })");
  const auto r = frustum({"run", graph, "--set", "m:file=broken.obj"});
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, AllOf(HasSubstr("g.json:2:56 /nodes/m/params/file"),
                           HasSubstr("(from --set m:file=broken.obj)")));
}

TEST(MissingFiles, AreWhatIsNoRegularFile) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe.obj").c_str(), 0600), 0);
  std::filesystem::create_directory(folder.file("folder.obj"));
  std::filesystem::create_symlink("nowhere.obj", folder.file("dangling.obj"));
  std::filesystem::create_symlink("loop.obj", folder.file("loop.obj"));
  const std::string long_name(5000, 'x');
  EXPECT_EQ(why_missing(folder.file("pipe.obj"), "pipe.obj"), "'pipe.obj' is not a regular file");
  EXPECT_EQ(why_missing(folder.file("folder.obj"), "folder.obj"), "'folder.obj' is a folder, not a file");
  EXPECT_EQ(why_missing(folder.file("dangling.obj"), "dangling.obj"), "there is no file 'dangling.obj'");
  EXPECT_THAT(why_missing(folder.file("loop.obj"), "loop.obj"), HasSubstr("cannot be a file"));
  EXPECT_THAT(why_missing(folder.file(long_name), "x"), HasSubstr("cannot be a file"));
  EXPECT_EQ(why_missing(folder.file("pipe.obj/x"), "pipe.obj/x"), "there is no file 'pipe.obj/x'");
  EXPECT_EQ(why_missing("/proc/self/mem", "mem"), "") << "it is there, whether it can be read or not";
  EXPECT_THAT(near_files(folder.file(long_name), long_name), IsEmpty());
  EXPECT_THAT(near_files("/nowhere/at/all", "all"), IsEmpty());
  folder.write("model.obj", "");
  EXPECT_THAT(near_files(folder.file("modle.obj"), "../x/modle.obj"), ElementsAre("../x/model.obj"));
}

// A file that is there and cannot be read is no mistake of the graph.
TEST(MissingFiles, AGraphThatCannotBeReadIsTheWorldsFailure) {
  const TempFolder folder;
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1", "nodes": {
    "g": { "type": "graph", "file": "/proc/self/mem" } } })");
  const auto r = frustum({"check", graph});
  EXPECT_EQ(r.code, 3);
  EXPECT_THAT(r.err, AllOf(HasSubstr("error[cannot_read_file]"), HasSubstr("g.json:2:37 /nodes/g/file: "),
                           Not(HasSubstr("missing_file"))));
}

// What looks beside each missing file is bounded: this would take hours otherwise.
TEST(MissingFiles, AHundredThousandOfThemAreFoundInSeconds) {
  const TempFolder folder;
  for (int i = 0; i < 1000; ++i) folder.write("a_file_with_a_long_name_" + std::to_string(i) + ".obj", "");
  std::string text = R"({ "format": "frustum.graph/1", "nodes": {)";
  for (int i = 0; i < 20000; ++i)
    text += (i == 0 ? "" : ",\n") + ("\"n" + std::to_string(i)) +
            R"(": { "type": "io.load_mesh", "params": { "file": "a_file_with_a_lnog_name.obj" } })";
  const Session session;
  const Loaded loaded = session.load(folder.write("g.json", text + "} }"));
  std::size_t found = 0, helped = 0;
  for (const Diagnostic& d : loaded.problems.list())
    if (d.code == "missing_file") ++found, helped += d.suggestions.empty() ? 0 : 1;
  EXPECT_EQ(found, 20000u);
  EXPECT_EQ(helped, most_looked_beside);
}

}  // namespace
}  // namespace frustum
