// What every node type and every example graph has to hold: walked from the registry and the folders, so
// that a node that is added is held to it without a line here.
#include "runtime/app/catalog.h"
#include "runtime/app/effects/prove.h"
#include "runtime/app/files.h"
#include "runtime/app/metrics/metrics.h"
#include "runtime/app/session.h"
#include "runtime/app/simd.h"
#include "runtime/app/suite/suite.h"
#include "runtime/buffers/mesh.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

namespace frustum {
namespace {

namespace fs = std::filesystem;
const fs::path root = FRUSTUM_SOURCE_DIR;

Session& session() {
  static Session s;
  return s;
}

// ----- documentation

std::string plain(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c >= 'A' && c <= 'Z')
      out += static_cast<char>(c - 'A' + 'a');
    else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
      out += c;
  }
  return out.starts_with("the") ? out.substr(3) : out;
}

void expect_sentence(const std::string& what, std::string_view name, const std::string& doc) {
  EXPECT_TRUE(doc.ends_with('.')) << what << ": its doc ends with a full stop";
  EXPECT_LE(doc.size(), 120u) << what;
  EXPECT_NE(plain(doc), plain(name)) << what << ": its doc says more than its name";
  EXPECT_GE(std::count(doc.begin(), doc.end(), ' '), 1) << what << ": its doc is a sentence";
}

void expect_fields_documented(const std::string& what, const ParamType& record) {
  std::set<std::string> names;
  for (const ParamField& f : record.fields) {
    EXPECT_TRUE(names.insert(f.name).second) << what << "." << f.name << " is described twice";
    expect_sentence(what + "." + f.name, f.name, f.doc);
    const ParamType* inner = f.type;
    while (inner->element != nullptr) inner = inner->element;
    if (inner->kind == ParamType::Kind::record) expect_fields_documented(what + "." + f.name, *inner);
  }
}

class EveryNode : public testing::TestWithParam<std::string> {
 protected:
  const NodeType& type() const { return *session().registry().find(GetParam()); }
};

TEST_P(EveryNode, IsDocumented) {
  expect_sentence(GetParam(), GetParam(), type().doc);
  for (const Port& p : type().inputs) expect_sentence(GetParam() + " input " + p.name, p.name, p.doc);
  for (const Port& p : type().outputs) expect_sentence(GetParam() + " output " + p.name, p.name, p.doc);
  for (const EffectDoc& e : type().effects) expect_sentence(GetParam() + " effect " + e.name, e.name, e.doc);
  expect_fields_documented(GetParam(), type().params);
  for (const int row : type().rows) EXPECT_TRUE(row >= 1 && row <= 143) << row;
}

TEST_P(EveryNode, DescribesEveryMemberOfItsStructs) {
  EXPECT_EQ(type().inputs.size(), type().input_members);
  EXPECT_EQ(type().outputs.size(), type().output_members);
  EXPECT_EQ(type().params.fields.size(), type().param_members);
  EXPECT_FALSE(type().outputs.empty());
}

TEST_P(EveryNode, HasValidDefaults) {
  const auto defaults = type().default_params();
  const Json written = write_record(type().params, defaults.get());
  Diagnostics problems;
  ParamReader reader(problems, "/params", "");
  const auto again = type().default_params();
  read_record(type().params, written, again.get(), reader);
  EXPECT_TRUE(problems.empty()) << to_text(problems);
  EXPECT_EQ(write_record(type().params, again.get()), written);
}

// The values of a knob as --set would give them: JSON, or text that stands for itself.
Json knob_value(const std::string& text) {
  Json value = Json::parse(text, nullptr, false);
  return value.is_discarded() ? Json(text) : value;
}

TEST_P(EveryNode, HasKnobsWhoseValuesItTakes) {
  for (const ParamField& f : type().params.fields) {
    if (!f.knob) continue;
    const std::string what = GetParam() + ":" + f.name;
    expect_sentence(what + " knob", f.name, f.knob->basis);
    EXPECT_GE(f.knob->values.size(), 2u) << what;
    std::set<std::string> seen;
    for (const std::string& text : f.knob->values) {
      EXPECT_TRUE(seen.insert(text).second) << what << " names " << text << " twice";
      Diagnostics problems;
      ParamReader reader(problems, "/params", "");
      const auto params = type().default_params();
      read_record(type().params, Json{{f.name, knob_value(text)}}, params.get(), reader);
      EXPECT_TRUE(problems.empty()) << what << "=" << text << "\n" << to_text(problems);
      const Json kept = write_record(type().params, params.get())[f.name];
      EXPECT_EQ(kept, knob_value(text)) << what << " is not kept as it was set";
    }
    if (!f.knob->slope) continue;
    double last = 0;  // a slope needs numbers, and an order that gets better
    for (const std::string& text : f.knob->values) {
      ASSERT_TRUE(knob_value(text).is_number()) << what << ": only numbers have a slope";
      const double v = knob_value(text).get<double>();
      EXPECT_GT(v, 0) << what;
      if (last != 0) {
        EXPECT_EQ(*f.knob->slope<0, v> last) << what << ": " << text << " is not more exact";
      }
      last = v;
    }
  }
}

TEST_P(EveryNode, HasAnExampleThatUsesItAndTheFilesOfItsName) {
  std::string path = GetParam();
  path[path.find('.')] = '/';
  for (const std::string& file :
       {"nodes/" + path + ".h", "nodes/" + path + ".cpp", "tests/nodes/" + path + "_test.cpp"})
    EXPECT_TRUE(fs::is_regular_file(root / file)) << file;
  const fs::path example = root / example_path(GetParam());
  ASSERT_TRUE(fs::is_regular_file(example)) << example_path(GetParam());
  const Loaded loaded = session().load(example.string());
  ASSERT_TRUE(loaded.graph) << to_text(loaded.problems);
  const auto& nodes = loaded.graph->nodes;
  EXPECT_TRUE(std::any_of(nodes.begin(), nodes.end(), [&](const GraphNode& n) { return n.type == &type(); }));
}

std::string test_name(std::string name) {
  for (char& c : name)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'))) c = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Conformance, EveryNode, testing::ValuesIn(session().registry().names()),
                         [](const auto& info) { return test_name(info.param); });

// ----- example graphs

std::vector<std::string> graphs_in(std::initializer_list<const char*> patterns) {
  std::vector<std::string> out;
  for (const char* pattern : patterns)
    for (const fs::path& p : matching_files(root / pattern))
      out.push_back(p.lexically_relative(root).generic_string());
  return out;
}

// Where a graph has them: a resolution that no tile edge divides, and few samples.
LoadOptions small(const fs::path& graph) {
  LoadOptions options;
  const Json file = Json::parse(read_text(graph));
  const Json params = file.value("params", Json::object());
  if (params.contains("resolution")) options.settings.push_back({"resolution", "[147, 83]"});
  if (params.contains("samples")) options.settings.push_back({"samples", "4"});
  return options;
}

struct Variant {
  int threads = 0, tile = 0;
  bool fuse = true;
};

class EveryGraph : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    Loaded loaded = session().load((root / GetParam()).string(), small(root / GetParam()));
    ASSERT_TRUE(loaded.graph) << to_text(loaded.problems);
    graph_ = std::move(*loaded.graph);
    options_.demand.ports = end_ports(graph_);
    for (const GraphOutput& output : graph_.outputs)
      for (const OutputLayer& layer : output.layers) options_.demand.ports.push_back(layer.from);
    for (const PortName& n : graph_.port_names) options_.demand.ports.push_back(n.port);
  }

  RunResult run(const Variant& v, std::optional<Rect> region = {}) {
    RunOptions options = options_;
    options.threads = v.threads, options.tile_edge = v.tile, options.fuse = v.fuse, options.region = region;
    RunResult r = session().run(graph_, options, false);
    EXPECT_EQ(r.end, RunResult::End::done) << to_text(r.problems);
    return r;
  }

  std::map<std::string, std::string> digests(const Variant& v) {
    std::map<std::string, std::string> out;
    for (const auto& [port, buffer] : run(v).buffers) out[graph_.name(port)] = to_hex(buffer.digest());
    return out;
  }

  Graph graph_;
  RunOptions options_;
};

TEST_P(EveryGraph, MakesFiniteBuffers) {
  for (const auto& [port, buffer] : run({}).buffers) {
    const Health h = buffer.health();
    EXPECT_TRUE(h.finite()) << graph_.name(port) << ": " << h.first;
    if (const auto mesh = buffer.as<Mesh>()) {
      EXPECT_EQ(mesh->validate(), "") << graph_.name(port);
    }
  }
}

TEST_P(EveryGraph, HasTheSameBytesForEveryThreadCountTileSizeAndFusion) {
  const auto expected = digests({});
  ASSERT_FALSE(expected.empty());
  for (const int threads : {1, 2, 7})
    EXPECT_EQ(digests({.threads = threads, .tile = 32}), expected) << threads << " threads";
  for (const int tile : {16, 32, 64, 128, -1})
    EXPECT_EQ(digests({.tile = tile}), expected) << "tile edge " << tile;
  EXPECT_EQ(digests({.fuse = false}), expected) << "not fused";
  EXPECT_EQ(digests({.threads = 7, .tile = 16, .fuse = false}), expected)
      << "not fused, 7 threads, tile edge 16";
}

TEST_P(EveryGraph, HasTheSameBytesForEverySimdTarget) {
  const auto expected = digests({});
  std::string missing;
  for (const auto& [target, name] : choices(Simd{})) {
    if (use_simd(target))
      EXPECT_EQ(digests({}), expected) << name;
    else
      missing += fmt::format(" {}", name);
    use_best_simd();
  }
  if (!missing.empty()) GTEST_SKIP() << "the others hold; this processor lacks:" << missing;
}

Raster cut(const Raster& whole, Rect region) {
  Frame frame = whole.frame();
  frame.window = intersection(frame.window, region);
  Raster out(frame);
  if (!frame.window.empty()) copy(whole.view(), out.view());
  return out;
}

TEST_P(EveryGraph, HasTheBytesOfTheWholeInEveryRegion) {
  const RunResult whole = run({});
  for (const Rect region : {Rect{3, 2, 4, 3}, Rect{5, 1, 12, 6}, Rect{0, 0, 10000, 10000}}) {
    const RunResult part = run({}, region);
    for (const auto& [port, buffer] : whole.buffers) {
      if (!buffer.type().is_pixels()) continue;
      const Raster& all = buffer.type().raster(buffer.data());
      if (intersection(all.frame().window, region).empty()) continue;
      const Buffer& crop = part.buffers.at(port);
      const Difference d = compare(cut(all, region), crop.type().raster(crop.data()));
      EXPECT_TRUE(d.identical()) << graph_.name(port) << ": " << to_json(d).dump();
    }
  }
}

// With every effect that is off simulated, all at once and one by one: plan --prove.
TEST_P(EveryGraph, KeepsEveryBitWhereWhatIsOffIsForced) {
  const Proof proof = prove_effects(session(), graph_, options_.demand, {.repeats = 0});
  EXPECT_TRUE(proof.holds()) << proof_text(proof) << to_text(proof.problems);
}

INSTANTIATE_TEST_SUITE_P(Conformance, EveryGraph,
                         testing::ValuesIn(graphs_in({"graphs/nodes/*/*.json", "graphs/gallery/*.json"})),
                         [](const auto& info) {
                           return test_name(fs::path(info.param).replace_extension().string().substr(7));
                         });

// The lessons too. What the libraries do is proved inside the graphs that use them.
class EveryLesson : public EveryGraph {};
TEST_P(EveryLesson, KeepsEveryBitWhereWhatIsOffIsForced) {
  const Proof proof = prove_effects(session(), graph_, options_.demand, {.repeats = 0});
  EXPECT_TRUE(proof.holds()) << proof_text(proof) << to_text(proof.problems);
}

INSTANTIATE_TEST_SUITE_P(Conformance, EveryLesson, testing::ValuesIn(graphs_in({"graphs/lessons/*/*.json"})),
                         [](const auto& info) {
                           return test_name(fs::path(info.param).replace_extension().string().substr(7));
                         });

TEST(Conformance, EveryExampleGraphIsInASuite) {
  std::set<std::string> covered;
  for (const fs::path& file : matching_files(root / "tests/suites/*.json")) {
    Diagnostics problems;
    const auto suite = load_suite(file.string(), problems);
    ASSERT_TRUE(suite) << to_text(problems);
    for (const SuiteCase& c : suite->cases)
      if (c.expected.empty())
        covered.insert(
            fs::weakly_canonical(c.graph).lexically_relative(fs::canonical(root)).generic_string());
  }
  for (const std::string& graph :
       graphs_in({"graphs/nodes/*/*.json", "graphs/gallery/*.json", "graphs/lessons/*/*.json"}))
    EXPECT_TRUE(covered.contains(graph)) << graph << " is in no suite";
  // A library has inputs, so that it runs inside other graphs.
  for (const std::string& library : graphs_in({"graphs/lib/*.json"})) {
    const std::string used = "\"lib:" + fs::path(library).stem().string() + "\"";
    const bool inside = std::any_of(covered.begin(), covered.end(), [&](const std::string& graph) {
      return read_text(root / graph).find(used) != std::string::npos;
    });
    EXPECT_TRUE(inside) << library << " is used by no graph that is in a suite";
  }
}

TEST(Conformance, SchemasAndPagesAreUpToDate) {
  const auto changes =
      write_catalog(session().registry(), {(root / "schemas").string(), (root / "docs").string()}, true);
  EXPECT_THAT(changes.written, testing::IsEmpty()) << "./dev docs writes them anew";
  EXPECT_THAT(changes.removed, testing::IsEmpty()) << "./dev docs removes them";
}

// ----- geometry that is degenerate: a documented result or a NodeError, never a crash, never a mesh that
// breaks its invariants

class EveryMeshNode : public EveryNode {};

std::vector<std::string> mesh_nodes() {
  std::vector<std::string> out;
  for (const auto& [name, type] : session().registry()) {
    const auto takes_mesh = [](const Port& p) { return p.takes(buffer_type<Mesh>()); };
    if (type.run && std::any_of(type.inputs.begin(), type.inputs.end(), takes_mesh)) out.push_back(name);
  }
  return out;
}

std::shared_ptr<Column> like(const Column& c, std::size_t rows) {
  return std::make_shared<Column>(c.name(), c.domain(), c.kind(), c.width(), rows, c.space());
}

Ref<Mesh> without_faces(const Mesh& mesh) {
  Mesh empty = mesh;
  for (Ref<Column>& c : empty.columns)
    if (c->domain() != Domain::mesh) c = like(*c, 0);
  return std::make_shared<const Mesh>(std::move(empty));
}

Ref<Mesh> with_positions(const Mesh& mesh, double value) {
  const Column& old = mesh.at("position");
  auto bad = like(old, old.rows());
  const std::size_t count = old.rows() * static_cast<std::size_t>(old.width());
  if (old.kind() == NumberKind::f32)
    std::fill_n(static_cast<float*>(const_cast<void*>(bad->data())), count, static_cast<float>(value));
  else
    std::fill_n(static_cast<double*>(const_cast<void*>(bad->data())), count, value);
  return std::make_shared<const Mesh>(mesh.with(std::move(bad)));
}

void expect_survives(const NodeType& type, std::vector<std::vector<Buffer>> inputs, const void* params,
                     const char* what) {
  Context ctx;
  try {
    for (const Buffer& b : type.run(inputs, params, ctx))
      if (const auto mesh = b.as<Mesh>()) {
        EXPECT_EQ(mesh->validate(), "") << type.name << " of " << what;
      }
  } catch (const NodeError& e) {
    EXPECT_FALSE(std::string(e.what()).empty()) << type.name << " of " << what;
  }
}

TEST_P(EveryMeshNode, SurvivesEmptyAndNonFiniteMeshes) {
  const Loaded loaded = session().load((root / example_path(GetParam())).string());
  ASSERT_TRUE(loaded.graph) << to_text(loaded.problems);
  const auto& nodes = loaded.graph->nodes;
  const auto node =
      std::find_if(nodes.begin(), nodes.end(), [&](const GraphNode& n) { return n.type == &type(); });
  ASSERT_NE(node, nodes.end());
  RunOptions options;
  for (const auto& list : node->inputs)
    for (const Source& s : list)
      if (const auto* port = std::get_if<PortRef>(&s)) options.demand.ports.push_back(*port);
  const RunResult r = session().run(*loaded.graph, options);
  ASSERT_EQ(r.end, RunResult::End::done) << to_text(r.problems);

  std::vector<std::vector<Buffer>> inputs;
  for (const auto& list : node->inputs) {
    inputs.emplace_back();
    for (const Source& s : list)
      inputs.back().push_back(std::holds_alternative<Buffer>(s) ? std::get<Buffer>(s)
                                                                : r.buffers.at(std::get<PortRef>(s)));
  }
  for (std::size_t i = 0; i < inputs.size(); ++i)
    for (std::size_t k = 0; k < inputs[i].size(); ++k) {
      const auto mesh = inputs[i][k].as<Mesh>();
      if (!mesh) continue;
      const auto with = [&](const Ref<Mesh>& bad, const char* what) {
        auto changed = inputs;
        changed[i][k] = Buffer(bad);
        expect_survives(type(), std::move(changed), node->params.get(), what);
      };
      with(without_faces(*mesh), "no faces");
      with(with_positions(*mesh, std::numeric_limits<double>::quiet_NaN()), "NaN positions");
      with(with_positions(*mesh, std::numeric_limits<double>::infinity()), "infinite positions");
      with(with_positions(*mesh, 0), "positions that are all zero");
    }
}

INSTANTIATE_TEST_SUITE_P(Conformance, EveryMeshNode, testing::ValuesIn(mesh_nodes()),
                         [](const auto& info) { return test_name(info.param); });

}  // namespace
}  // namespace frustum
