#include "runtime/app/suite/read.h"

#include "runtime/app/files.h"
#include "runtime/core/text.h"
#include "runtime/graph/source_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <set>

namespace frustum {
namespace fs = std::filesystem;
namespace {

constexpr const char* format = "frustum.suite/1";
constexpr std::size_t most_cases = 100000;

// YYYY-MM-DD with a month and a day that exist in some year; dates compare as texts.
bool is_date(const std::string& s) {
  const auto digit = [&](std::size_t i) { return s[i] >= '0' && s[i] <= '9'; };
  if (s.size() != 10 || s[4] != '-' || s[7] != '-') return false;
  for (const std::size_t i : {0U, 1U, 2U, 3U, 5U, 6U, 8U, 9U})
    if (!digit(i)) return false;
  const int month = std::stoi(s.substr(5, 2)), day = std::stoi(s.substr(8, 2));
  constexpr std::array<int, 12> days{31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  return month >= 1 && month <= 12 && day >= 1 && day <= days[static_cast<std::size_t>(month - 1)];
}

class Reader {
 public:
  Reader(const std::string& path, Diagnostics& problems)
      : parser_(fs::path(path).parent_path().string(), problems), at_(parser_.at) {}

  void read(const Json& file, Suite& suite) {
    if (!file.is_object()) return parser_.wrong("a suite, which is an object");
    for (const auto& [key, value] : file.items()) check_key(key);
    if (file.value("format", Json()) != format) {
      const std::string message = fmt::format("expected \"format\": \"{}\"", format);
      if (!file.contains("format"))
        parser_.missing(message);
      else
        at_.inside("format", [&] { at_.problem("bad_format", message); });
    }
    if (file.contains("title") && file["title"].is_string()) suite.title = file["title"].get<std::string>();
    read_presets(file);
    if (!file.contains("cases")) return parser_.missing("a suite needs \"cases\"");
    at_.inside("cases", [&] {
      if (!file["cases"].is_array()) return parser_.wrong("an array of cases");
      for (std::size_t i = 0; i < file["cases"].size(); ++i)
        at_.inside(i, [&] { read_case(file["cases"][i], suite); });
    });
  }

 private:
  void check_key(const std::string& key) {
    static const std::vector<std::string> known{"$schema", "format", "title", "presets", "cases"};
    if (std::find(known.begin(), known.end(), key) != known.end()) return;
    at_.inside(key, [&] {
      at_.problem("unknown_key", fmt::format("'{}' is not a key here", key),
                  fmt::format("one of: {}", fmt::join(known, ", ")), key, nearest_names(key, known));
    });
  }

  template <class Keys>
  Variation variation(const Keys& k) {
    return {parser_.settings("set", k.set), parser_.matrix("matrix", k.matrix)};
  }

  void read_presets(const Json& file) {
    if (!file.contains("presets")) return;
    at_.inside("presets", [&] {
      if (!file["presets"].is_object()) return parser_.wrong("an object of presets");
      for (const auto& [name, preset] : file["presets"].items())
        at_.inside(name, [&, &name = name, &preset = preset] {
          presets_[name] = variation(parser_.keys<suite_keys::Preset>(preset));
        });
    });
  }

  Variation presets_of(const std::vector<std::string>& names) {
    Variation v;
    at_.inside("use", [&] {
      for (std::size_t i = 0; i < names.size(); ++i)
        at_.inside(i, [&] {
          const auto found = presets_.find(names[i]);
          if (found != presets_.end()) return v.override_with(found->second);
          std::vector<std::string> known;
          for (const auto& [name, preset] : presets_) known.push_back(name);
          at_.problem("unknown_preset", fmt::format("there is no preset '{}'", names[i]), {}, names[i],
                      nearest_names(names[i], known));
        });
    });
    return v;
  }

  void read_case(const Json& j, Suite& suite) {
    const auto k = parser_.keys<suite_keys::Case>(j);
    if (j.is_object() && (k.id.empty() || k.graph.empty()))
      parser_.missing("a case needs an \"id\" and a \"graph\"");
    if (!k.id.empty() && !case_ids_.insert(k.id).second) duplicate(k.id);
    if (std::any_of(k.id.begin(), k.id.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }))
      at_.inside("id", [&] {
        at_.problem("bad_id", "an id is one line of text: it stands in reports and in commands",
                    "printable characters");
      });
    SuiteCase c;
    c.pointer = at_.pointer();
    c.id = k.id, c.tags = k.tags, c.precision = k.precision;
    c.skip = k.skip, c.timeout = k.timeout, c.retry = k.retry;
    Variation v = presets_of(k.use);
    v.override_with(variation(k));
    parser_.each("checks", k.checks, [&](const Json& check) {
      c.checks.push_back(read_check(parser_, check));
      c.checks.back().pointer = at_.pointer();
    });
    parser_.each("expect", k.expect, [&](const Json& e) { read_expected(e, c); });
    read_budget(k.budget, c.budget);
    if (k.waiver) read_waiver(*k.waiver, c);
    if (!k.id.empty() && !k.graph.empty()) add_cases(k.graph, c, v, suite);
  }

  void read_expected(const Json& e, SuiteCase& c) {
    const auto k = parser_.keys<suite_keys::Expect>(e);
    if (e.is_object() && k.code.empty()) parser_.missing("an expected diagnostic needs a \"code\"");
    c.expected.push_back({k.code, k.pointer, k.suggestion, k.line, k.column});
  }

  void read_budget(const suite_keys::Budget& k, Budget& budget) {
    at_.inside("budget", [&] {
      parser_.inside("bytes", k.bytes, [&](const Json& j) {
        if (j.is_number_unsigned())
          budget.bytes = j.get<std::uint64_t>();
        else if (j.is_string())
          budget.bytes = parse_bytes(j.get<std::string>());
        if (!budget.bytes) parser_.wrong("a number of bytes, or a size such as \"256M\"");
      });
      parser_.inside("counters", k.counters, [&](const Json& j) {
        if (!j.is_object()) return parser_.wrong("an object of counters and the most they may be");
        for (const auto& [name, most] : j.items()) {
          if (most.is_number_unsigned())
            budget.counters[name] = most.get<std::uint64_t>();
          else
            at_.inside(name, [&] { parser_.wrong("a count"); });
        }
      });
      if (k.time)
        budget.time =
            std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(*k.time));
    });
  }

  void read_waiver(const suite_keys::Waiver& k, SuiteCase& c) {
    at_.inside("waiver", [&] {
      if (k.until.empty() || k.why.empty())
        return parser_.missing("a waiver needs \"until\", a date, and \"why\"");
      if (!is_date(k.until))
        return at_.inside("until", [&] {
          at_.problem("bad_date", fmt::format("'{}' is no date: write it like 2026-12-31", k.until),
                      "YYYY-MM-DD", k.until);
        });
      c.waiver = Waiver{k.until, k.why};
    });
  }

  void add_cases(const std::string& pattern, const SuiteCase& c, const Variation& v, Suite& suite) {
    const std::size_t first = suite.cases.size();
    const Expanded end = expand(parser_.path(pattern), c, v, most_cases - first, suite.cases);
    if (end == Expanded::no_file)
      at_.inside("graph", [&] { at_.problem("no_match", fmt::format("no file matches '{}'", pattern)); });
    if (end == Expanded::too_many)
      at_.problem("too_many_cases",
                  fmt::format("files and matrix make the suite larger than {} cases", most_cases));
    for (std::size_t i = first; i < suite.cases.size(); ++i) {
      const std::string& id = suite.cases[i].id;
      if (!ids_.insert(id).second && id != c.id) return duplicate(id);
    }
  }

  void duplicate(const std::string& id) {
    at_.inside("id", [&] { at_.problem("duplicate_id", fmt::format("another case is named '{}'", id)); });
  }

  SuiteParser parser_;
  ParamReader& at_;
  std::map<std::string, Variation> presets_;
  std::set<std::string> case_ids_, ids_;  // as written, and with files and values
};

}  // namespace

void SuiteParser::inside(const char* key, const JsonText& json,
                         const std::function<void(const Json&)>& body) {
  if (!json.given()) return;
  const Json j = Json::parse(json.text);
  at.inside(key, [&] { body(j); });
}

void SuiteParser::each(const char* key, const JsonText& list, const std::function<void(const Json&)>& body) {
  inside(key, list, [&](const Json& j) {
    if (j.is_object() && std::string_view(key) == "expect") return body(j);  // one stands for a list of one
    if (!j.is_array()) return wrong("an array");
    for (std::size_t i = 0; i < j.size(); ++i) at.inside(i, [&] { body(j[i]); });
  });
}

std::map<std::string, std::string> SuiteParser::settings(const char* key, const JsonText& json) {
  std::map<std::string, std::string> out;
  inside(key, json, [&](const Json& j) {
    if (!j.is_object()) return wrong("an object of addresses and values");
    for (const auto& [address, value] : j.items()) out[address] = value.dump();
  });
  return out;
}

std::map<std::string, std::vector<std::string>> SuiteParser::matrix(const char* key, const JsonText& json) {
  std::map<std::string, std::vector<std::string>> out;
  inside(key, json, [&](const Json& j) {
    if (!j.is_object()) return wrong("an object of addresses and lists of values");
    for (const auto& [address, list] : j.items()) {
      if (!list.is_array() || list.empty()) {
        at.inside(address, [&] { wrong("a list of one or more values"); });
        continue;
      }
      for (const Json& value : list) out[address].push_back(value.dump());
    }
  });
  return out;
}

std::string SuiteParser::path(const std::string& written) const {
  return (fs::path(folder) / written).lexically_normal().string();
}

bool ExpectedProblem::matches(const Diagnostic& d) const {
  return d.code == code && (pointer.empty() || d.pointer == pointer) && (line == 0 || d.line == line) &&
         (column == 0 || d.column == column) &&
         (suggestion.empty() ||
          std::find(d.suggestions.begin(), d.suggestions.end(), suggestion) != d.suggestions.end());
}

std::optional<Suite> load_suite(const std::string& path, Diagnostics& problems) {
  return load_suite_text(read_text(path), path, problems);
}

std::optional<Suite> load_suite_text(std::string written, const std::string& path, Diagnostics& problems) {
  Diagnostics mine;
  const auto text = SourceText::read(std::move(written), path, mine);
  Suite suite;
  suite.file = path, suite.name = fs::path(path).stem().string();
  if (text->complete()) {
    Diagnostics found;
    Reader(path, found).read(text->json(), suite);
    for (Diagnostic& d : found.list()) {
      if (d.code == "unknown_param") {  // the reader of records speaks of parameters; here they are keys
        d.code = "unknown_key";
        d.message = fmt::format("'{}' is not a key here", d.got);
      }
      const TextPlace place =
          d.code == "unknown_key" ? text->key_place(d.pointer) : text->value_place(d.pointer);
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
