// tests/bad/NAME.json must give exactly the diagnostics of NAME.expected.json: none missing, none more, none different.
//
// After a change of wording, FRUSTUM_ACCEPT=1 in the environment writes the files anew; the difference is then for
// whoever commits it to judge.
#include "nodes/all_nodes.h"
#include "runtime/app/session.h"
#include "runtime/graph/load.h"
#include "runtime/io/image_files.h"
#include "runtime/io/sink_plan.h"
#include "tests/support/temp_file.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

namespace frustum {
namespace {

namespace fs = std::filesystem;

const fs::path& root() {
  static const fs::path path = FRUSTUM_SOURCE_DIR;
  return path;
}

std::string content(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

const Registry& registry() {
  static const Registry all(all_node_types());
  return all;
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(root() / "tests/bad")) {
    const std::string file = entry.path().filename().string();
    if (entry.is_regular_file() && file.ends_with(".json") && !file.ends_with(".expected.json"))
      out.push_back(file.substr(0, file.size() - 5));
  }
  std::sort(out.begin(), out.end());
  return out;
}

// Every text without the folder that the checkout happens to lie in.
void forget_folder(Json& j, const std::string& folder) {
  if (j.is_string()) {
    auto text = j.get<std::string>();
    for (std::size_t at; (at = text.find(folder)) != std::string::npos;) text.erase(at, folder.size());
    j = text;
  } else if (j.is_structured()) {
    for (Json& item : j) forget_folder(item, folder);
  }
}

// A graph whose files are what is bad shows it when it runs.
bool shows_when_run(const std::string& name) {
  return name.starts_with("asset_") || name == "display_format_linear";
}

Json diagnostics_of(const std::string& name) {
  const fs::path folder = root() / "tests/bad";
  Session session;
  Loaded loaded = session.load((folder / (name + ".json")).string(),
                               {.library_folders = {(root() / "graphs/lib").string()}});
  EXPECT_EQ(loaded.graph.has_value(), !loaded.problems.has_errors());
  if (loaded.graph && shows_when_run(name)) {
    const test::TempFolder out;
    RunOptions options{.out_folder = out.path()};
    options.demand = demand_of(*loaded.graph, {}, loaded.problems);
    const RunResult result = session.run(*loaded.graph, options);
    EXPECT_EQ(result.end == RunResult::End::done, !result.problems.has_errors());
    EXPECT_EQ(fs::is_empty(out.path()), result.files.empty());
    loaded.problems.add(result.problems);
    Json j = to_json(loaded.problems);
    forget_folder(j, out.path() + "/");
    forget_folder(j, folder.string() + "/");
    return j;
  }
  Json j = to_json(loaded.problems);
  forget_folder(j, folder.string() + "/");
  return j;
}

class BadGraph : public testing::TestWithParam<std::string> {};

TEST_P(BadGraph, HasExactlyItsDiagnostics) {
  const Json got = diagnostics_of(GetParam());
  const fs::path path = root() / "tests/bad" / (GetParam() + ".expected.json");
  if (std::getenv("FRUSTUM_ACCEPT") != nullptr) std::ofstream(path) << got.dump(2) << '\n';
  const Json expected = Json::parse(content(path), nullptr, false);
  EXPECT_EQ(got.dump(2), expected.dump(2));
  EXPECT_FALSE(got["diagnostics"].empty());
  for (const Json& d : got["diagnostics"]) {
    EXPECT_GT(d["line"], 0) << d;
    EXPECT_GT(d["column"], 0) << d;
    EXPECT_FALSE(d["message"].get<std::string>().ends_with('.')) << d;
    EXPECT_TRUE(shows_when_run(GetParam()) || !d["expected"].get<std::string>().empty()) << d;
  }
}

INSTANTIATE_TEST_SUITE_P(Folder, BadGraph, testing::ValuesIn(names()),
                         [](const auto& name) { return name.param; });

// ----- good graphs: the gallery, the library, the examples of the documentation

std::vector<std::string> errors(const Loaded& l) {
  std::vector<std::string> out;
  for (const Diagnostic& d : l.problems.list())
    if (d.severity == Severity::error) out.push_back(d.file + d.pointer + " " + d.message);
  return out;
}

TEST(GoodGraphs, OfTheGalleryAndTheLibraryHaveNoProblem) {
  int graphs = 0;
  for (const char* folder : {"graphs/gallery", "graphs/lib"})
    for (const auto& entry : fs::directory_iterator(root() / folder)) {
      if (entry.path().extension() != ".json") continue;
      const Loaded l = load_graph(entry.path().string(), registry(),
                                  {.library_folders = {(root() / "graphs/lib").string()}});
      EXPECT_EQ(errors(l), std::vector<std::string>{}) << entry.path();
      for (const Diagnostic& d : l.problems.list()) EXPECT_EQ(d.code, "open_input") << d.message;
      ++graphs;
    }
  EXPECT_GE(graphs, 4);
}

TEST(GoodGraphs, OfTheDocumentationHaveNoProblem) {
  const std::string text = content(root() / "docs/graph_format.md");
  const std::string open = "```json\n", close = "\n```";
  int examples = 0;
  for (std::size_t at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    const std::string example = text.substr(at, text.find(close, at) - at);
    const Loaded l = load_graph_text(example, (root() / "docs/example.json").string(), registry(),
                                     {.library_folders = {(root() / "graphs/lib").string()}});
    EXPECT_EQ(errors(l), std::vector<std::string>{});
    ++examples;
  }
  EXPECT_EQ(examples, 2);
}

// What is said of a file before the run is what its writer will do.
TEST(Outputs, AreCheckedAsTheyAreWritten) {
  const auto accepted = [](const std::string& extension, int bits, const std::string& compression) {
    const std::string text =
        R"({ "format": "frustum.graph/1", "nodes": { "a": { "type": "io.load_image", "params": { "file": "a.exr" } } },
      "outputs": { "o": { "from": "a", "file": "o.)" +
        extension + "\"" + (bits != 0 ? ", \"bits\": " + std::to_string(bits) : "") +
        (compression.empty() ? "" : ", \"compression\": \"" + compression + "\"") + " } } }";
    return load_graph_text(text, "t.json", registry()).graph.has_value();
  };
  const auto written = [](const std::string& extension, int bits, const std::string& compression) {
    SinkRequest request{.path = "o." + extension,
                        .region = {0, 0, 4, 4},
                        .display_window = {0, 0, 4, 4},
                        .layers = {},
                        .bits = bits,
                        .compression = compression,
                        .metadata = {}};
    Frame frame;
    frame.window = request.region;
    for (const char* plane : {"R", "G", "B"}) frame.planes.push_back({plane, PlaneKind::f32});
    request.layers.push_back({"", frame});
    try {
      plan_sink(request);
      return true;
    } catch (const NodeError&) {
      return false;
    }
  };
  std::vector<std::string> extensions = writable_extensions();
  extensions.insert(extensions.end(), {"bmp", "EXR", "webp"});
  int good = 0;
  for (const std::string& extension : extensions)
    for (const int bits : {0, 8, 10, 16, 32})
      for (const char* compression : {"", "none", "zip", "zips", "lzw", "packbits", "dwaa", "piz", "rle",
                                      "b44a", "pxr24", "quality:90", "quality:0", "quality:101", "best"}) {
        EXPECT_EQ(accepted(extension, bits, compression), written(extension, bits, compression))
            << extension << " " << bits << " " << compression;
        good += written(extension, bits, compression);
      }
  EXPECT_GT(good, 50);
}

// The author set near, far is what it is where nobody says otherwise: near is what he looks for.
TEST(BadGraphs, AFaultOfValuesTogetherStandsAtWhatWasSet) {
  const auto camera = [](const std::string& params, const LoadOptions& options = {}) {
    const Loaded l = load_graph_text(
        R"({ "format": "frustum.graph/1", "nodes": { "camera": { "type": "scene.camera", "params": { )" +
            params + R"( } } }, "outputs": { "o": { "from": "camera" } } })",
        "t.json", registry(), options);
    EXPECT_EQ(l.problems.size(), 1u) << to_text(l.problems);
    return l.problems.empty() ? Diagnostic() : l.problems.list().front();
  };
  const auto has = [](const Diagnostic& d, const char* part) {
    EXPECT_NE(d.message.find(part), std::string::npos) << d.message;
  };
  const Diagnostic set = camera(R"("fov_y": 40, "near": 20000)");
  EXPECT_EQ(set.pointer, "/nodes/camera/params/near");
  EXPECT_EQ(set.got, "20000");
  has(set, "('far' is 1000");
  EXPECT_EQ(camera(R"("near": 20, "far": 10)").pointer, "/nodes/camera/params/far");

  const LoadOptions forced{.settings = {{"camera:near", "20000"}}};
  const Diagnostic over = camera(R"("fov_y": 40)", forced);
  EXPECT_EQ(over.pointer, "/nodes/camera/params/near");
  has(over, "(from --set camera:near=20000)");
  const Diagnostic both = camera(R"("far": 10)", forced);
  EXPECT_EQ(both.pointer, "/nodes/camera/params/far");
  has(both, "(from --set camera:near=20000)");
}

TEST(BadGraphs, AHundredThousandBracketsAreOneProblem) {
  for (const std::string open : {"[", "{\"a\":", "{\"nodes\":["}) {
    std::string text;
    for (int i = 0; i < 100000; ++i) text += open;
    const Loaded l = load_graph_text(text, "deep.json", registry());
    ASSERT_EQ(l.problems.size(), 1u);
    EXPECT_EQ(l.problems.list()[0].code, "too_deep");
    EXPECT_EQ(l.problems.list()[0].line, 1);
  }
}

// ----- the codes and their pages

// Codes of what is checked before anything runs: those in the sources of the loader and of parameters.
std::set<std::string> load_codes() {
  const std::regex pattern(R"re((?:\.code = |\bproblem\(\s*|\bstop\(\s*|\bwarning\(\s*)"([a-z_]+)")re");
  const std::regex source(R"((document|json_|source_text|flatten|params|check|load|param).*\.cpp)");
  std::set<std::string> out;
  for (const char* folder : {"runtime/graph", "runtime/core"})
    for (const auto& entry : fs::directory_iterator(root() / folder)) {
      if (!std::regex_match(entry.path().filename().string(), source)) continue;
      const std::string text = content(entry.path());
      for (std::sregex_iterator m(text.begin(), text.end(), pattern), end; m != end; ++m) out.insert((*m)[1]);
    }
  return out;
}

std::set<std::string> sections() {
  std::set<std::string> out;
  const std::string text = content(root() / "docs/diagnostics.md");
  const std::regex heading(R"(\n### ([a-z_]+)\n)");
  for (std::sregex_iterator m(text.begin(), text.end(), heading), end; m != end; ++m) out.insert((*m)[1]);
  return out;
}

TEST(DiagnosticCodes, HaveTheirSection) {
  const auto codes = load_codes();
  EXPECT_GT(codes.size(), 30u);
  const auto known = sections();
  for (const std::string& code : codes)
    EXPECT_TRUE(known.contains(code)) << code << " has no section in docs/diagnostics.md";
}

TEST(DiagnosticCodes, OfLoadingHaveABadGraph) {
  // What no small file can show has a test of its own in load_test.cpp.
  std::set<std::string> shown = {"too_large", "no_frame_parameter", "frame_set_twice"};
  for (const std::string& name : names()) {
    const Json expected = Json::parse(content(root() / "tests/bad" / (name + ".expected.json")));
    for (const Json& d : expected["diagnostics"]) shown.insert(d["code"]);
  }
  for (const std::string& code : load_codes())
    EXPECT_TRUE(shown.contains(code)) << code << " has no file in tests/bad";
}

}  // namespace
}  // namespace frustum
