// What accuracy costs: a graph is run at many settings, each measured against a reference and timed.
//
// A knob is a setting that trades accuracy for time. One at a time, every other knob stays where the graph
// has it; on a grid, every combination is a point. Each point has two errors: against the reference of the
// whole sweep, and (one at a time) against the same graph with that knob alone at its most exact value, which
// shows the knob's own error without the floor of the others. Slopes are fitted to the second.
#pragma once

#include "runtime/app/session.h"

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace frustum {

struct SweepKnob {
  std::string address;  // "draw/pattern:samples", a graph parameter, or "precision" of the whole graph
  std::vector<std::string> values;  // as --set takes them, from cheap to exact
  std::string current;              // where the graph has it; empty where it cannot be told
  std::string basis;                // of the declaration, if it has one
  std::optional<double> slope;      // of log(error) over log(value) that theory expects
};

struct SweepOptions {
  std::string graph;
  LoadOptions load = {};  // settings of every point and of the reference
  std::vector<std::string> knobs =
      {};  // "ADDR=V1,V2,..." or "ADDR"; none: every declared knob but those of taste
  bool grid = false;
  std::vector<std::string> reference = {};      // "ADDR=VALUE"; none: every knob at its most exact value
  std::string reference_file = {};              // or a picture
  std::vector<std::string> metrics = {"rmse"};  // the first one is plotted, fitted and ranked
  std::string want = {};                        // an output or port; empty: the graph's first
  int repeats = 5;
  int threads = 0;
  std::string folder;
  std::string markdown = {};  // FOLDER/NAME of the pictures of sweep_markdown, if it will be asked for
  bool resume = false;
  const CancelFlag* cancel = nullptr;
  std::function<void(std::size_t done, std::size_t all, const std::string& what)> progress = {};
};

// Sums of one run that depend on no clock: "draw/hits samples", "mesh triangles".
using WorkCounters = std::map<std::string, std::uint64_t>;

struct SweepPoint {
  std::string key;                  // of everything that its buffer depends on: graph, settings, files, build
  std::vector<std::string> values;  // one a knob
  std::optional<std::size_t> knob;  // one at a time: the one that was turned; none for the graph as it is
  std::map<std::string, double, std::less<>> errors;  // against the reference, by metric
  // First metric, by knob: against the same graph with that knob alone at its most exact value. Of the knob that was
  // turned; of the graph as it is, every knob's.
  std::map<std::size_t, double> own_errors;
  WorkCounters counters;
  std::uint64_t work = 0;  // vertices, triangles, samples and the like that all nodes went through
  std::vector<std::chrono::nanoseconds> times;
  bool pareto = false;  // no other point is at once faster and nearer the reference

  double error(const std::string& metric) const { return errors.at(metric); }
  std::optional<double> own_error(std::size_t of_knob) const {
    const auto at = own_errors.find(of_knob);
    return at == own_errors.end() ? std::nullopt : std::optional(at->second);
  }
  std::optional<double> own_error() const { return knob ? own_error(*knob) : std::nullopt; }
};

// A straight line through log(error) over log(x), by least squares.
struct SlopeFit {
  double slope = 0, intercept = 0;  // log10(error) = slope log10(x) + intercept
  double r2 = 0;                    // the share of the errors' variance that the line explains
  std::size_t points = 0;
};

// How one knob's own error falls. Fitted to points with an error, at least a factor of 4 from the most exact
// value, whose own error shows in those nearer; absent with fewer than 3 of them.
struct KnobFit {
  std::size_t knob = 0;
  std::optional<SlopeFit> over_value, over_time, over_work;
  bool without_effect = false;  // no value is off from the most exact one
};

// From the graph as it is to one turn of one knob.
struct SweepStep {
  std::size_t point = 0;
  double time_ms = 0;          // more (or less, below 0)
  double error_ratio = 1;      // new over old
  double halvings_per_ms = 0;  // of the error, for more accurate steps; infinite where they cost nothing
};

// Where the wall-clock time of a sweep went, in seconds. Running the graph is what is measured; everything else is what
// measuring adds.
struct SweepCosts {
  double timed = 0;      // runs whose time counts
  double first = 0;      // the run of each setting that gives its error and counters, and warms up
  double reference = 0;  // the run of the reference
  double loading = 0;    // graphs read, checked and given their settings; files of io nodes
  double judging = 0;    // errors, thumbnails and error maps
  double journal = 0;
  double report = 0;  // the page, CSV and JSON; write_sweep() adds it
  double total = 0;   // of the sweep, its report included

  double runs() const { return timed + first + reference; }
  // The measuring overhead: the share of the whole time in which no graph ran.
  double overhead() const { return total > 0 ? 1 - runs() / total : 0; }
};

struct Sweep {
  SweepOptions options;
  std::string title, port, kind, reference;  // what was measured, its kind of buffer, and against what
  std::vector<SweepKnob> knobs;
  std::vector<SweepPoint> points;  // one at a time, the first is the graph as it is
  std::vector<KnobFit> fits;
  std::vector<SweepStep> steps;  // the best buys first
  std::size_t resumed = 0;       // points taken from an earlier run
  SweepCosts costs;              // of this run of it, not of the one that it resumes
  std::string machine;
};

// The knobs that `want` depends on, or those named. Throws NodeError with the code of the diagnostic.
std::vector<SweepKnob> sweep_knobs(Session&, const Graph&, PortRef want, const SweepOptions&);

// Runs the sweep and writes its journal and pictures below options.folder; with `resume` what an earlier,
// cut-off run of the same sweep finished is not run again. Bad graphs, and a folder in which files of the sweep would
// take the place of those it reads, are reported in `problems` and give nothing. Throws NodeError for a wrong option,
// RunFailure where a setting cannot run, Cancelled (what is finished is kept), WorldError.
//
// Timed is what run_graph does from the plan to the finished buffer, with no cache and nobody listening. Not
// timed: reading and checking the graph, and its io nodes: files are read once and stand in the graphs as
// literals. One run of each point is made first, for its error and counters; then `repeats` rounds go through
// all points in turn. Errors are measured once a point, and between runs, never beside one.
std::optional<Sweep> run_sweep(Session&, const SweepOptions&, Diagnostics& problems);

std::chrono::nanoseconds min_of(const SweepPoint&);
std::chrono::nanoseconds median_of(const SweepPoint&);
std::chrono::nanoseconds deviation_of(const SweepPoint&);  // median absolute deviation from the median

}  // namespace frustum
