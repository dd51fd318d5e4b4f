// A suite file: graphs, the settings to run them with, and what has to hold of their buffers.
#pragma once

#include "runtime/core/diagnostic.h"
#include "runtime/graph/load.h"

#include <optional>
#include <string>
#include <vector>

namespace frustum {

// One value of a buffer of pixels.
struct Probe {
  int x = 0, y = 0, sample = 0;
  std::string plane;  // empty: the first
  double equals = 0, abs = 0;
};

// What has to hold of one port. Every number of it has to be finite, whatever else is asked.
struct SuiteCheck {
  std::string port;
  bool golden = false;  // compared with what was accepted
  std::string same_as;  // or with another port of the same run
  bool exact = false;
  std::optional<double> abs, max, rmse;
  double fraction = 1;  // share of the values for which abs has to hold
  std::optional<Probe> probe;
  std::string shape;  // JSON object: entries of the summary; empty: not asked
  std::string why;

  bool has_tolerance() const { return abs || max || rmse; }
};

// A diagnostic that loading or running has to give; empty texts and zeros match anything.
struct ExpectedProblem {
  std::string code, pointer, suggestion;
  int line = 0, column = 0;
  bool matches(const Diagnostic&) const;
};

// One run: presets are resolved, one combination of the matrix is chosen, one file of the pattern is taken.
struct SuiteCase {
  std::string id;     // "teapot[samples=4]", "examples/clip/homogeneous"
  std::string graph;  // the path of the graph file
  std::vector<Setting> settings;
  std::optional<Precision> precision;  // above the graph's own
  std::vector<SuiteCheck> checks;
  std::vector<ExpectedProblem> expected;
  std::vector<std::string> tags;
};

struct Suite {
  std::string file, name;  // "tests/suites/gallery.json", "gallery"
  std::vector<SuiteCase> cases;
};

// Null where a problem is an error; problems have file, line and column. Throws WorldError where the file
// cannot be read.
std::optional<Suite> load_suite(const std::string& path, Diagnostics& problems);

}  // namespace frustum
