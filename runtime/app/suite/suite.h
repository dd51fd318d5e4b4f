// A suite file: graphs, the settings to run them with, and what has to hold of their buffers.
#pragma once

#include "runtime/app/suite/check.h"
#include "runtime/core/diagnostic.h"

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

// A diagnostic that loading or running has to give; empty texts and zeros match anything.
struct ExpectedProblem {
  std::string code, pointer, suggestion;
  int line = 0, column = 0;
  bool matches(const Diagnostic&) const;
};

// What a run may cost. Bytes and counters are the same on every machine and fail; time only says so.
struct Budget {
  std::optional<std::uint64_t> bytes;  // live at once, at the peak
  std::map<std::string, std::uint64_t>
      counters;  // "triangles_clipped", or "cut:triangles_clipped" of one node
  std::optional<std::chrono::nanoseconds> time;
};

// A failure that is known: it does not count until the date has passed. Then it counts, whatever the case
// does.
struct Waiver {
  std::string until;  // "2026-12-31", the last day (UTC)
  std::string why;
};

// One run: presets are resolved, one combination of the matrix is chosen, one file of the pattern is taken.
struct SuiteCase {
  std::string id;       // "teapot[samples=4]", "examples/clip/homogeneous"
  std::string graph;    // the path of the graph file
  std::string pointer;  // of the case in the suite's file
  std::vector<Setting> settings;
  std::optional<Precision> precision;  // above the graph's own
  std::vector<SuiteCheck> checks;
  std::vector<ExpectedProblem> expected;
  std::vector<std::string> tags;
  Budget budget;
  std::optional<Waiver> waiver;
  std::string skip;               // why it is not run; empty: it is
  std::optional<double> timeout;  // seconds, instead of the run's
  int retry = 0;                  // further attempts after one that did not pass
};

struct Suite {
  std::string file, name;  // "tests/suites/gallery.json", "gallery"
  std::string title;
  std::vector<SuiteCase> cases;
};

// Null where a problem is an error; problems have file, line and column. Throws WorldError where the file
// cannot be read. Cost: linear in the text and the number of cases, of which a file may have 100,000.
std::optional<Suite> load_suite(const std::string& path, Diagnostics& problems);

// The same from text; `path` is what graphs are found from and what messages name.
std::optional<Suite> load_suite_text(std::string text, const std::string& path, Diagnostics& problems);

// JSON Schema (draft 2020-12) of suite files, from the declarations that the reader reads by.
Json suite_schema();

}  // namespace frustum
