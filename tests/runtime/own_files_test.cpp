// Nothing that is made from a graph takes the place of a file that the graph was read from.
#include "runtime/graph/own_files.h"

#include "runtime/app/files.h"
#include "tests/support/process.h"
#include "tests/support/temp_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <map>

namespace frustum {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::frustum;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view inner_text = R"({ "format": "frustum.graph/1",
  "nodes": { "box": { "type": "mesh.box" } }, "outputs": { "mesh": { "from": "box" } } })";
constexpr std::string_view outer_text = R"({ "format": "frustum.graph/1",
  "nodes": { "made": { "type": "graph", "file": "parts/inner.json" } },
  "outputs": { "first": { "from": "made.mesh", "file": "new/box.ply" },
               "table": { "from": "made.mesh", "file": "FILE" } } })";

// A graph and one that it uses, with a second output to `file`.
struct Graphs {
  explicit Graphs(const std::string& file = "table.json") : text(outer_text) {
    fs::create_directory(folder.file("parts"));
    inner = folder.write("parts/inner.json", inner_text);
    text.replace(text.find("FILE"), 4, file);
    outer = folder.write("outer.json", text);
  }
  void expect_untouched() const {
    EXPECT_EQ(read_text(outer), text);
    EXPECT_EQ(read_text(inner), inner_text);
  }
  test::TempFolder folder;
  std::string text, inner, outer;
};

TEST(OwnFiles, OptionsThatNameOneAreRefused) {
  const Graphs g;
  fs::create_symlink(g.outer, g.folder.file("other_name.json"));
  const std::string out = g.folder.file("out");
  for (const std::string& file :
       {g.outer, g.inner, g.folder.file("parts/../outer.json"), g.folder.file("other_name.json")})
    for (const std::vector<std::string>& command :
         std::vector<std::vector<std::string>>{{"report", g.outer, "-o", file},
                                               {"inspect", g.outer, "made/box", "--save", file},
                                               {"run", g.outer, "--out", out, "--trace", file}}) {
      const auto r = frustum(command);
      EXPECT_EQ(r.code, 2) << testing::PrintToString(command);
      EXPECT_THAT(r.err, AllOf(HasSubstr("error[overwrites_graph]"),
                               HasSubstr(fs::equivalent(file, g.inner) ? "inner.json" : "outer.json")));
      EXPECT_FALSE(fs::exists(out)) << "nothing ran";
      g.expect_untouched();
    }
}

TEST(OwnFiles, OutputsThatAreOneAreRefused) {
  for (const std::string file : {"outer.json", "parts/inner.json"}) {
    const Graphs g(file);
    const auto r = frustum({"run", "outer.json", "--out", ".", "--json"}, g.folder.path());
    EXPECT_EQ(r.code, 2) << file;
    const json d = json::parse(r.out)["diagnostics"];
    ASSERT_EQ(d.size(), 1u) << d;
    EXPECT_EQ(d[0]["code"], "overwrites_graph");
    EXPECT_EQ(d[0]["pointer"], "/outputs/table/file");
    EXPECT_EQ(d[0]["line"], 4);
    const std::string line = g.text.substr(g.text.rfind('\n') + 1);
    EXPECT_EQ(d[0]["column"], line.find("\"" + file) + 1) << "where its file's name stands";
    g.expect_untouched();
    EXPECT_FALSE(fs::exists(g.folder.file("new"))) << "nothing ran";
    EXPECT_EQ(frustum({"run", "outer.json", "--out", ".", "--want", "first"}, g.folder.path()).code, 0);
    EXPECT_TRUE(fs::exists(g.folder.file("new/box.ply")));
  }
}

// What the nodes read, and what that names beside itself.
TEST(OwnFiles, AssetsAreNotWrittenOver) {
  const test::TempFolder folder;
  const std::map<std::string, std::string> assets{
      {"one.obj", "mtllib one.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"},
      {"one.mtl", "newmtl m\nmap_Kd card.png\n"},
      {"card.png", read_text(std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data/card.png")}};
  for (const auto& [name, text] : assets) folder.write(name, text);
  const auto graph = [&](const std::string& file) {
    return folder.write("graph.json", R"({ "format": "frustum.graph/1", "nodes": {
      "mesh": { "type": "io.load_mesh", "params": { "file": "one.obj" } },
      "picture": { "type": "io.load_image", "params": { "file": "card.png" } } },
      "outputs": { "mesh": { "from": "mesh", "file": "a.ply" }, "out": { "from": ")" +
                                          std::string(file.ends_with("png") ? "picture" : "mesh") +
                                          R"(", "file": ")" + file + R"(" } } })");
  };
  const auto expect_refused = [&](const std::vector<std::string>& command, const std::string& name) {
    const auto r = frustum(command, folder.path());
    EXPECT_EQ(r.code, 2) << testing::PrintToString(command);
    EXPECT_THAT(r.err, AllOf(HasSubstr("error[overwrites_graph]"), HasSubstr(name)));
    for (const auto& [file, text] : assets) EXPECT_EQ(read_text(folder.file(file)), text);
  };
  for (const std::string name : {"one.obj", "card.png"}) {
    graph(name);
    expect_refused({"run", "graph.json", "--out", "."}, name);
  }
  graph("b.ply");
  for (const auto& [name, text] : assets) {
    expect_refused({"report", "graph.json", "-o", name}, name);
    expect_refused({"inspect", "graph.json", "mesh", "--save", name}, name);
    expect_refused({"run", "graph.json", "--trace", name}, name);
  }
}

TEST(OwnFiles, ATraceIsNoOutput) {
  const Graphs g;
  const auto r = frustum({"run", "outer.json", "--out", ".", "--trace", "new/box.ply"}, g.folder.path());
  EXPECT_EQ(r.code, 2);
  EXPECT_THAT(r.err, AllOf(HasSubstr("error[duplicate_file]"), HasSubstr("output 'first'")));
  EXPECT_FALSE(fs::exists(g.folder.file("new")));
}

TEST(OwnFiles, OtherFilesAreWrittenOver) {
  const Graphs g;
  for (int i = 0; i < 2; ++i) {
    const auto r =
        frustum({"run", g.outer, "--out", g.folder.path(), "--trace", g.folder.file("trace.json")});
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_EQ(frustum({"report", g.outer, "-o", g.folder.file("page.html")}).code, 0);
  }
  g.expect_untouched();
}

TEST(OwnFiles, AGraphThatCannotBeReadIsNoTrace) {
  const test::TempFolder folder;
  const auto bad = folder.write("bad.json", "{");
  EXPECT_EQ(frustum({"run", bad, "--trace", bad}).code, 2);
  EXPECT_EQ(read_text(bad), "{");
}

// ----- sweeps and suites

// A graph that reads a picture, and a suite of it with a book of goldens.
struct Swept {
  Swept() {
    for (const char* name : {"golden", "suites"}) fs::create_directory(folder.file(name));
    fs::copy_file(std::string(FRUSTUM_SOURCE_DIR) + "/graphs/data/card.png", picture);
    graph = folder.write("graph.json", R"({ "format": "frustum.graph/1",
      "nodes": { "card": { "type": "io.load_image", "params": { "file": "card.png" } },
                 "shown": { "type": "color.convert", "in": { "image": "card" }, "params": { "to": "srgb" } } },
      "outputs": { "shown": { "from": "shown", "file": "shown.exr" } } })");
    suite = folder.write("suites/small.json", R"({ "format": "frustum.suite/1", "cases": [
      { "id": "card", "graph": "../graph.json" } ] })");
    book = folder.write("golden/small.json", R"({ "format": "frustum.golden/1", "entries": {} })");
  }
  test::TempFolder folder;
  std::string picture = folder.file("card.png"), graph, suite, book;
};

void expect_refused(const std::vector<std::string>& command, const std::string& file,
                    const std::string& name) {
  const std::string before = read_text(file);
  const auto r = frustum(command);
  EXPECT_EQ(r.code, 2) << testing::PrintToString(command) << r.err;
  EXPECT_THAT(r.err, AllOf(HasSubstr("error[overwrites_graph]"), HasSubstr(name + ", which is read")));
  EXPECT_EQ(read_text(file), before);
}

TEST(OwnFiles, ASweepIsNotWrittenOverWhatItReads) {
  const Swept s;
  for (const char* name : {"sweep.json", "sweep.csv", "points.jsonl"}) {
    const std::string folder = s.folder.file(std::string("to_") + name), file = folder + "/" + name;
    fs::create_directory(folder);
    fs::copy_file(s.picture, folder + "/card.png");
    fs::copy_file(s.graph, file);
    expect_refused({"sweep", file, "--knob", "precision=single,double", "-o", folder}, file, name);
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2)
        << "nothing is made";
  }
  // What its nodes read, and the reference.
  const std::string folder = s.folder.file("out");
  fs::create_directories(folder + "/pictures");
  fs::create_hard_link(s.picture, folder + "/sweep.html");
  expect_refused({"sweep", s.graph, "--knob", "precision=single,double", "-o", folder}, s.picture,
                 "card.png");
  fs::remove(folder + "/sweep.html");
  fs::copy_file(s.picture, folder + "/pictures/reference.png");
  expect_refused({"sweep", s.graph, "--knob", "precision=single,double", "--reference-file",
                  folder + "/pictures/reference.png", "-o", folder},
                 folder + "/pictures/reference.png", "reference.png");
  // And what a page for docs/ would write.
  fs::create_hard_link(s.picture, s.folder.file("doc_0.png"));
  expect_refused({"sweep", s.graph, "--knob", "precision=single,double", "--markdown", s.folder.file("doc"),
                  "-o", s.folder.file("new")},
                 s.folder.file("doc_0.png"), "card.png");
  EXPECT_FALSE(fs::exists(s.folder.file("new")));
}

TEST(OwnFiles, TheResultsOfASuiteAreNotWrittenOverWhatItReads) {
  const Swept s;
  for (const std::string& file : {s.suite, s.graph, s.picture, s.book})
    for (const char* option : {"--junit", "--html"})
      expect_refused({"test", s.suite, option, file}, file, fs::path(file).filename().string());
  // Over results of before they are, and over what is no input.
  const std::string page = s.folder.file("page.html"), xml = s.folder.file("results.xml");
  s.folder.write("page.html", "notes");
  for (int i = 0; i < 2; ++i) {
    const auto r = frustum({"test", s.suite, "--junit", xml, "--html", page});
    EXPECT_EQ(r.code, 0) << r.out << r.err;
    EXPECT_TRUE(read_text(page).starts_with("<!doctype html>"));
  }
  const auto one = frustum({"test", s.suite, "--junit", xml, "--html", s.folder.file("./results.xml")});
  EXPECT_EQ(one.code, 2) << one.err;
  EXPECT_THAT(one.err, HasSubstr("one file"));
}

TEST(OwnFiles, ARunThatFailsLeavesNoEmptyFolder) {
  const test::TempFolder folder;
  const auto graph = folder.write("g.json", R"({ "format": "frustum.graph/1",
    "nodes": { "box": { "type": "mesh.box" }, "camera": { "type": "scene.camera" },
               "eye": { "type": "project.view", "in": { "mesh": "box", "camera": "camera" } },
               "clip": { "type": "project.perspective", "in": { "mesh": "eye", "camera": "camera" } } },
    "outputs": { "o": { "from": "clip", "file": "a/b/clip.ply" } } })");
  const auto r = frustum({"run", graph, "--out", folder.file("out")});
  EXPECT_EQ(r.code, 2) << r.err;
  EXPECT_THAT(r.err, HasSubstr("format_cannot_hold"));
  EXPECT_FALSE(fs::exists(folder.file("out")));
  EXPECT_EQ(frustum({"inspect", graph, "clip", "--save", folder.file("deep/er/clip.ply")}).code, 2);
  EXPECT_FALSE(fs::exists(folder.file("deep")));
}

}  // namespace
}  // namespace frustum
