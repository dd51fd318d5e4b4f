#include "runtime/app/suite.h"

#include "runtime/app/files.h"
#include "runtime/core/param.h"
#include "runtime/graph/source_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace frustum {
namespace fs = std::filesystem;
namespace {

// ----- the parts of the file that have fixed keys; the others (set, matrix, shape) are read by hand
struct ProbeKeys {
  glm::ivec2 pixel{0};
  int sample = 0;
  std::string plane;
  double equals = 0, abs = 0;
};
void describe(Fields<ProbeKeys>& f) {
  f.field("pixel", &ProbeKeys::pixel, "Column and row.")
      .field("sample", &ProbeKeys::sample, "Which sample.", {.range = at_least(0)})
      .field("plane", &ProbeKeys::plane, "Which plane; the first if left out.")
      .field("equals", &ProbeKeys::equals, "What it should be.")
      .field("abs", &ProbeKeys::abs, "How far it may be from that.", {.range = at_least(0)});
}

struct CheckKeys {
  std::string port, same_as, why;
  bool golden = false, exact = false;
  std::optional<double> abs, max, rmse;
  double fraction = 1;
  std::optional<ProbeKeys> probe;
};
void describe(Fields<CheckKeys>& f) {
  f.field("port", &CheckKeys::port, "A port or an output.")
      .field("golden", &CheckKeys::golden, "Compared with what was accepted.")
      .field("same_as", &CheckKeys::same_as, "Compared with this port.")
      .field("exact", &CheckKeys::exact, "Bit for bit.")
      .field("abs", &CheckKeys::abs, "Bound for each value.", {.range = at_least(0)})
      .field("fraction", &CheckKeys::fraction, "Share for which it holds.", {.range = between(0, 1)})
      .field("max", &CheckKeys::max, "Bound for every value.", {.range = at_least(0)})
      .field("rmse", &CheckKeys::rmse, "Bound for the root mean square.", {.range = at_least(0)})
      .field("probe", &CheckKeys::probe, "One value.")
      .field("why", &CheckKeys::why, "The reason for a tolerance.");
}

struct ExpectKeys {
  std::string code, pointer, suggestion;
  int line = 0, column = 0;
};
void describe(Fields<ExpectKeys>& f) {
  f.field("code", &ExpectKeys::code, "Of the diagnostic.")
      .field("pointer", &ExpectKeys::pointer, "Where it points.")
      .field("line", &ExpectKeys::line, "Its line.")
      .field("column", &ExpectKeys::column, "Its column.")
      .field("suggestion", &ExpectKeys::suggestion, "One of its suggestions.");
}

struct CaseKeys {
  std::string id, graph;
  std::vector<std::string> use, tags;
  std::optional<Precision> precision;
};
void describe(Fields<CaseKeys>& f) {
  f.field("id", &CaseKeys::id, "Unique name.")
      .field("graph", &CaseKeys::graph, "A graph file, or a pattern of them.")
      .field("use", &CaseKeys::use, "Presets.")
      .field("tags", &CaseKeys::tags, "For --filter.")
      .field("precision", &CaseKeys::precision, "The Real of the nodes, above the graph's own.");
}

// Values by address, and lists of values by address.
struct Variation {
  std::map<std::string, Json> set, matrix;
};

class Reader {
 public:
  Reader(std::string path, Diagnostics& problems) : path_(std::move(path)), at_(problems, "", "") {}

  void read(const Json& file, Suite& suite) {
    if (!file.is_object()) return wrong("expected a suite, which is an object");
    for (const auto& [key, value] : file.items()) {
      static const std::vector<std::string> known{"$schema", "format", "title", "presets", "cases"};
      if (std::find(known.begin(), known.end(), key) == known.end())
        at_.inside(key, [&] { unknown(key, known); });
    }
    if (file.value("format", Json()) != "frustum.suite/1")
      at_.inside("format", [&] { wrong("expected \"format\": \"frustum.suite/1\""); });
    read_presets(file);
    if (!file.contains("cases") || !file["cases"].is_array()) return wrong("expected \"cases\", an array");
    at_.inside("cases", [&] {
      for (std::size_t i = 0; i < file["cases"].size(); ++i)
        at_.inside(i, [&] { read_case(file["cases"][i], suite); });
    });
  }

 private:
  void wrong(std::string message) { at_.problem("wrong_type", std::move(message)); }
  void unknown(const std::string& key, const std::vector<std::string>& known) {
    at_.problem("unknown_key", fmt::format("'{}' is not a key here", key),
                fmt::format("one of: {}", fmt::join(known, ", ")), key, nearest_names(key, known));
  }

  // Takes the members named in `own` out of an object, and reads the rest into a struct with fixed keys.
  template <class Keys>
  Keys read_keys(const Json& object, std::initializer_list<const char*> own) {
    Keys keys;
    if (!object.is_object()) {
      wrong("expected an object");
      return keys;
    }
    std::vector<std::string> known(own.begin(), own.end());
    for (const ParamField& f : param_type<Keys>().fields) known.push_back(f.name);
    Json rest = Json::object();
    for (const auto& [key, value] : object.items()) {
      if (std::find(known.begin(), known.end(), key) == known.end())
        at_.inside(key, [&] { unknown(key, known); });
      else if (std::find(own.begin(), own.end(), key) == own.end())
        rest[key] = value;
    }
    read_record(param_type<Keys>(), rest, &keys, at_);
    return keys;
  }

  void read_map(const Json& object, const char* key, bool lists, std::map<std::string, Json>& out) {
    if (!object.is_object() || !object.contains(key)) return;
    at_.inside(key, [&] {
      if (!object[key].is_object()) return wrong("expected an object of addresses and values");
      for (const auto& [address, value] : object[key].items()) {
        if (lists && (!value.is_array() || value.empty()))
          at_.inside(address, [&] { wrong("expected a list of values"); });
        else
          out[address] = value;
      }
    });
  }

  Variation read_variation(const Json& object) {
    Variation v;
    read_map(object, "set", false, v.set);
    read_map(object, "matrix", true, v.matrix);
    return v;
  }

  void read_presets(const Json& file) {
    if (!file.contains("presets")) return;
    at_.inside("presets", [&] {
      if (!file["presets"].is_object()) return wrong("expected an object of presets");
      for (const auto& [name, preset] : file["presets"].items())
        at_.inside(name, [&] {
          for (const auto& [key, value] : preset.items())
            if (key != "set" && key != "matrix") at_.inside(key, [&] { unknown(key, {"set", "matrix"}); });
          presets_[name] = read_variation(preset);
        });
    });
  }

  SuiteCheck read_check(const Json& j) {
    const auto k = read_keys<CheckKeys>(j, {"shape"});
    SuiteCheck c{.port = k.port,
                 .golden = k.golden,
                 .same_as = k.same_as,
                 .exact = k.exact,
                 .abs = k.abs,
                 .max = k.max,
                 .rmse = k.rmse,
                 .fraction = k.fraction,
                 .probe = {},
                 .shape = {},
                 .why = k.why};
    if (k.probe)
      c.probe = Probe{k.probe->pixel.x, k.probe->pixel.y, k.probe->sample,
                      k.probe->plane,   k.probe->equals,  k.probe->abs};
    if (c.port.empty()) at_.problem("missing_key", "a check needs a \"port\"");
    if (j.is_object() && j.contains("shape")) {
      if (j["shape"].is_object())
        c.shape = j["shape"].dump();
      else
        at_.inside("shape", [&] { wrong("expected an object: entries of the summary"); });
    }
    if ((c.has_tolerance() || c.exact) && !c.golden && c.same_as.empty())
      at_.problem("missing_key",
                  "a tolerance compares with something: \"golden\": true, or \"same_as\": PORT");
    if (c.golden && !c.same_as.empty())
      at_.problem("wrong_type", "either \"golden\" or \"same_as\", not both");
    if (c.exact && c.has_tolerance()) at_.problem("wrong_type", "\"exact\" leaves no tolerance");
    const bool above_zero = c.abs.value_or(0) > 0 || c.max.value_or(0) > 0 || c.rmse.value_or(0) > 0 ||
                            (c.probe && c.probe->abs > 0) || c.fraction < 1;
    if (above_zero && c.why.empty()) at_.problem("missing_key", "a tolerance above zero needs a \"why\"");
    return c;
  }

  void read_list(const Json& object, const char* key, bool or_one,
                 const std::function<void(const Json&)>& item) {
    if (!object.is_object() || !object.contains(key)) return;
    at_.inside(key, [&] {
      if (or_one && object[key].is_object()) return item(object[key]);
      if (!object[key].is_array()) return wrong("expected an array");
      for (std::size_t i = 0; i < object[key].size(); ++i) at_.inside(i, [&] { item(object[key][i]); });
    });
  }

  void read_case(const Json& j, Suite& suite) {
    const auto keys = read_keys<CaseKeys>(j, {"set", "matrix", "checks", "expect"});
    SuiteCase c;
    c.id = keys.id, c.tags = keys.tags, c.precision = keys.precision;
    if (keys.id.empty() || keys.graph.empty())
      at_.problem("missing_key", "a case needs an \"id\" and a \"graph\"");
    if (!keys.id.empty() && !ids_.insert(keys.id).second)
      at_.inside("id",
                 [&] { at_.problem("duplicate_id", fmt::format("another case is named '{}'", keys.id)); });
    Variation v;
    for (std::size_t i = 0; i < keys.use.size(); ++i) use_preset(keys.use[i], i, v);
    Variation own = read_variation(j);
    for (auto& [address, value] : own.set) v.matrix.erase(address), v.set[address] = std::move(value);
    for (auto& [address, values] : own.matrix) v.set.erase(address), v.matrix[address] = std::move(values);
    read_list(j, "checks", false, [&](const Json& check) { c.checks.push_back(read_check(check)); });
    read_list(j, "expect", true, [&](const Json& e) {
      const auto k = read_keys<ExpectKeys>(e, {});
      if (k.code.empty()) at_.problem("missing_key", "an expected diagnostic needs a \"code\"");
      c.expected.push_back({k.code, k.pointer, k.suggestion, k.line, k.column});
    });
    expand(keys.graph, c, v, suite);
  }

  void use_preset(const std::string& name, std::size_t index, Variation& v) {
    const auto found = presets_.find(name);
    if (found == presets_.end()) {
      std::vector<std::string> known;
      for (const auto& [n, p] : presets_) known.push_back(n);
      at_.inside("use", [&] {
        at_.inside(index, [&] {
          at_.problem("unknown_preset", fmt::format("there is no preset '{}'", name), {}, name,
                      nearest_names(name, known));
        });
      });
      return;
    }
    for (const auto& [address, value] : found->second.set) v.set[address] = value;
    for (const auto& [address, values] : found->second.matrix) v.matrix[address] = values;
  }

  // One case for every matching file and every combination of the matrix.
  void expand(const std::string& pattern, const SuiteCase& base, const Variation& v, Suite& suite) {
    const fs::path full = (fs::path(path_).parent_path() / pattern).lexically_normal();
    const auto files = matching_files(full);
    if (files.empty())
      at_.inside("graph", [&] { at_.problem("no_match", fmt::format("no file matches '{}'", pattern)); });
    const auto star = full.string().find('*');
    const fs::path fixed =
        star == std::string::npos ? fs::path() : fs::path(full.string().substr(0, star)).parent_path();
    for (const fs::path& file : files) {
      SuiteCase c = base;
      c.graph = file.generic_string();
      if (star != std::string::npos)
        c.id += "/" + fs::path(file).replace_extension().lexically_relative(fixed).generic_string();
      for (const auto& [address, value] : v.set) c.settings.push_back({address, value.dump()});
      combine(v.matrix.begin(), v.matrix.end(), c, "", suite);
    }
  }

  using Axis = std::map<std::string, Json>::const_iterator;
  static void combine(Axis axis, Axis end, const SuiteCase& c, const std::string& chosen, Suite& suite) {
    if (axis == end) {
      suite.cases.push_back(c);
      if (!chosen.empty()) suite.cases.back().id += "[" + chosen + "]";
      return;
    }
    for (const Json& value : axis->second) {
      SuiteCase next = c;
      next.settings.push_back({axis->first, value.dump()});
      const std::string shown = value.is_string() ? value.get<std::string>() : value.dump();
      combine(std::next(axis), end, next,
              fmt::format("{}{}{}={}", chosen, chosen.empty() ? "" : ",", axis->first, shown), suite);
    }
  }

  std::string path_;
  ParamReader at_;
  std::map<std::string, Variation> presets_;
  std::set<std::string> ids_;
};

}  // namespace

bool ExpectedProblem::matches(const Diagnostic& d) const {
  return d.code == code && (pointer.empty() || d.pointer == pointer) && (line == 0 || d.line == line) &&
         (column == 0 || d.column == column) &&
         (suggestion.empty() ||
          std::find(d.suggestions.begin(), d.suggestions.end(), suggestion) != d.suggestions.end());
}

std::optional<Suite> load_suite(const std::string& path, Diagnostics& problems) {
  Diagnostics mine;
  const auto text = SourceText::read(read_text(path), path, mine);
  Suite suite{path, fs::path(path).stem().string(), {}};
  if (text->complete()) {
    Diagnostics found;
    Reader(path, found).read(text->json(), suite);
    for (Diagnostic& d : found.list()) {
      const TextPlace place = text->value_place(d.pointer);
      d.file = path, d.line = place.line, d.column = place.column;
    }
    mine.add(found);
  }
  const bool bad = mine.has_errors();
  problems.add(mine);
  if (bad) return std::nullopt;
  return suite;
}

}  // namespace frustum
